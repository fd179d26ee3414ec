// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sgs/core/error.h"

namespace sgs::bag {

/// Largest piece of a file, or of what is unpacked from it, that is held in memory.
inline constexpr std::uint64_t kLargestPiece_bytes = std::uint64_t{1} << 30;

/// A file read in pieces, each checked against the file's size before memory is taken for it. Not
/// thread-safe.
class ByteFile {
 public:
  static Result<ByteFile> open(const std::filesystem::path& path);
  ~ByteFile();
  ByteFile(ByteFile&& other) noexcept;
  ByteFile& operator=(ByteFile&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Whether `bytes` bytes follow `offset`.
  bool holds(std::uint64_t offset, std::uint64_t bytes) const {
    return offset <= size_ && bytes <= size_ - offset;
  }
  /// Bytes [offset, offset + bytes); valid until the next call. Beyond the end is kInvalidFormat.
  Result<std::string_view> view(std::uint64_t offset, std::uint64_t bytes);

 private:
  ByteFile(std::filesystem::path path, int descriptor, std::uint64_t size);

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t buffer_at_ = 0;
  std::string buffer_;
};

/// The error of a file that does not begin as what its name says, which is called `expected`.
tl::unexpected<Error> not_of_its_name(ByteFile& file, const std::string& expected);

}  // namespace sgs::bag
