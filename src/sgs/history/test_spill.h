// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace sgs::history {

/// The nameless file that a store of this process has open in that folder, for writing; -1: none.
inline int open_spill_file_in(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const auto target = std::filesystem::read_symlink(entry.path(), gone).string();
    if (!gone && target.starts_with((folder / "sgs-spill-").string())) {
      return ::open(entry.path().c_str(), O_RDWR | O_CLOEXEC);
    }
  }
  return -1;
}

/// As if the disk had lost all of it.
inline bool empty_spill_file_in(const std::filesystem::path& folder) {
  const int file = open_spill_file_in(folder);
  if (file < 0) return false;
  const bool emptied = ::ftruncate(file, 0) == 0;
  ::close(file);
  return emptied;
}

}  // namespace sgs::history
