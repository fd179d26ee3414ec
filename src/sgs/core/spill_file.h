// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "sgs/core/error.h"

namespace sgs {

/// A nameless file for what does not fit into memory. It takes bytes and gives them back until the
/// object is gone or the program ends, however it ends; nothing stays behind.
class SpillFile {
 public:
  /// In the folder that TMPDIR names, else in /var/tmp: /tmp may itself be memory.
  static std::filesystem::path default_folder();
  static Result<SpillFile> create(const std::filesystem::path& folder = default_folder());

  /// Returns where the bytes lie. A full disk is an error, and nothing has happened then.
  /// Goes where as many bytes were released, else to the end.
  Result<std::int64_t> append(const void* bytes, std::size_t size);
  /// What append() put there is not needed any more.
  void release(std::int64_t at, std::size_t size) { free_[size].push_back(at); }
  /// Reads `size` bytes back from where append() put them. Throws std::system_error when the disk
  /// fails: there is no other copy.
  void read(std::int64_t at, void* bytes, std::size_t size) const;

 private:
  explicit SpillFile(int descriptor);

  std::shared_ptr<const int> file_;  // a descriptor; its owner closes it
  std::int64_t size_ = 0;
  std::map<std::size_t, std::vector<std::int64_t>> free_;  // by size
};

}  // namespace sgs
