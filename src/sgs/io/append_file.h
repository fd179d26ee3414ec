// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "sgs/core/error.h"

namespace sgs::io {

/// A file that grows while something goes on, line by line. What was appended survives the end of
/// the program, however it comes; after sync() also a power cut. Whoever reads it may meet half of
/// a last line (whole_lines()). For one thread at a time.
class AppendFile {
 public:
  /// The first append() makes the file; one of that name is emptied.
  explicit AppendFile(std::filesystem::path path);
  /// Goes on with a file that is there, behind its first `bytes`.
  AppendFile(std::filesystem::path path, std::size_t bytes);

  /// Takes `bytes` over; they go to the file with the next append() or sync().
  void hold(std::string_view bytes) { pending_ += bytes; }
  /// Appends what is held, and `bytes` after it. What does not fit (full disk) is held until the
  /// next time, so that nothing is ever missing in the middle.
  Status append(std::string_view bytes);
  /// Puts what was appended on the disk.
  Status sync();
  /// Where the file was removed under this object's hands: makes it again, with all it held.
  Status restore();

  const std::filesystem::path& path() const { return path_; }

 private:
  Status open();
  Status write_pending();

  std::filesystem::path path_;
  std::shared_ptr<const int> file_;  // a descriptor that its owner closes; null until it is needed
  std::size_t kept_ = 0;             // bytes of a file that was there
  std::string pending_;
  bool synced_ = true;  // nothing was written since the last sync()
};

/// What is left of a file that was being appended to when its writer died: the whole lines. The end
/// of the last one may be missing, and after a power cut there may be zeros instead of it.
std::string_view whole_lines(std::string_view text);

}  // namespace sgs::io
