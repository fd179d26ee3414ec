// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace sgs::viewer {

/// Files of a run that clients may have, by names that the program gives: nothing of a request
/// reaches the file system. Thread-safe.
class Downloads {
 public:
  /// An empty `file` takes the name back.
  void offer(const std::string& name, const std::filesystem::path& file) {
    const std::scoped_lock lock(mutex_);
    if (file.empty()) {
      files_.erase(name);
    } else {
      files_[name] = file;
    }
  }
  /// Empty where there is none of that name.
  std::filesystem::path find(std::string_view name) const {
    const std::scoped_lock lock(mutex_);
    const auto it = files_.find(name);
    return it == files_.end() ? std::filesystem::path() : it->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::filesystem::path, std::less<>> files_;
};

}  // namespace sgs::viewer
