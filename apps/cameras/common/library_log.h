// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <string>
#include <string_view>

namespace sgs::cameras {

/// What a library has logged and nobody has asked for: some say nowhere else why they failed.
/// Thread-safe.
class LibraryLog {
 public:
  void add(std::string_view line);
  /// All of it, with semicolons, and none of it the next time.
  std::string take();

 private:
  std::mutex mutex_;
  std::string lines_;
};

}  // namespace sgs::cameras
