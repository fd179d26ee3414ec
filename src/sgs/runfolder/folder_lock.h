// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "sgs/core/error.h"

namespace sgs::run {

/// Holds a run folder for this process, until the object is gone or the process ends, however it
/// ends. Any thread may call.
class FolderLock {
 public:
  /// Makes the folder where it is missing. Where another process holds it, the error says which.
  static Result<std::shared_ptr<FolderLock>> take(const std::filesystem::path& folder);
  /// Whether a process holds the folder at this moment.
  static bool is_held(const std::filesystem::path& folder);

  /// Makes sure that the folder is still there and still ours. One that was removed or moved away
  /// is made again, empty; an error where another run has taken its place.
  Status ensure();
  /// How often ensure() had to make the folder again.
  int times_made_again() const;

  const std::filesystem::path& folder() const { return folder_; }
  /// This process in words, as others are told and as state.toml says.
  const std::string& owner() const { return owner_; }

 private:
  explicit FolderLock(std::filesystem::path folder);
  Status acquire();

  std::filesystem::path folder_;
  std::string owner_;
  mutable std::mutex mutex_;
  std::shared_ptr<const int> file_;  // a descriptor; its owner closes it
  int made_again_ = 0;
};

}  // namespace sgs::run
