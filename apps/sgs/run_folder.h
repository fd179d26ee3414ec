// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::app {

/// The folder that keeps everything about one run. What cannot be written there (full disk,
/// permissions lost on the way) goes to a rescue folder instead, so that nothing computed is lost.
class RunFolder {
 public:
  /// Creates `requested`, or runs/<time>-<name> when it is empty, and points runs/latest to it.
  static Result<RunFolder> create(const std::filesystem::path& requested, const std::string& name);

  /// An existing run folder, to add to.
  static Result<RunFolder> open(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  /// Calls `write` with the path of `name` in this folder; when that fails, once more with a path
  /// in the rescue folder, and remembers the failure.
  template <class Writer>
  void save(const std::string& name, Writer&& write) {
    const Status first = write(path_ / name);
    if (first) return;
    failures_.push_back(first.error());
    if (const auto rescue = rescue_folder()) {
      if (const Status second = write(*rescue / name); !second) failures_.push_back(second.error());
    }
  }
  void save_text(const std::string& name, std::string_view text);

  /// Everything that could not be written where it belongs.
  const std::vector<Error>& failures() const { return failures_; }
  /// Where files went that did not fit into path(); empty when all is well.
  const std::filesystem::path& rescued_to() const { return rescue_; }

 private:
  explicit RunFolder(std::filesystem::path path) : path_(std::move(path)) {}
  Result<std::filesystem::path> rescue_folder();

  std::filesystem::path path_, rescue_;
  std::vector<Error> failures_;
};

}  // namespace sgs::app
