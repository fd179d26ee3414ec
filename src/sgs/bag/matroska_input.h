// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "sgs/bag/av_library.h"
#include "sgs/bag/chunked_bag.h"

namespace sgs::bag {

/// A time that is not said.
inline constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();
/// 30 years: a stamp beyond is none.
inline constexpr std::int64_t kLatest_ns = 1'000'000'000'000'000'000;

/// A Matroska file that is open for reading from its beginning, by FFmpeg. Packets come as they lie
/// in the file; nothing is decoded. Not thread-safe.
class MatroskaInput {
 public:
  /// Fails where there is no FFmpeg, and where the tracks cannot be read.
  static Result<MatroskaInput> open(const std::filesystem::path& path);
  ~MatroskaInput();
  MatroskaInput(MatroskaInput&& other) noexcept;
  MatroskaInput& operator=(MatroskaInput&&) = delete;

  std::span<AVStream* const> streams() const { return {context_->streams, context_->nb_streams}; }
  const AVFormatContext& file() const { return *context_; }

  /// A tag of the file or of one of its tracks; empty: none.
  std::string tag(const char* name) const;
  std::string entry(const AVDictionary* of, const char* name) const;

  /// Nothing is read of tracks that are not among these.
  void keep_only(std::span<const int> tracks);
  /// The next part of a track; null at the end, which damage is, too. Valid until the next call.
  const AVPacket* next();
  /// Since the file's beginning, nanoseconds; kNoTime: not said.
  std::int64_t time_ns(const AVPacket& packet) const;

 private:
  explicit MatroskaInput(const AvLibrary* av) : av_(av) {}

  const AvLibrary* av_;
  AVFormatContext* context_ = nullptr;
  AVPacket* packet_ = nullptr;
};

/// Where the segment ends that is all of a Matroska file behind its head, in bytes from the file's
/// beginning, as the head says; empty: it does not.
std::optional<std::uint64_t> announced_end(ByteFile& file);

}  // namespace sgs::bag
