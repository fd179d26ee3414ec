// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "library_log.h"

#include <utility>

namespace sgs::cameras {

void LibraryLog::add(std::string_view line) {
  constexpr std::size_t kMost = 2000;
  while (!line.empty() && line.back() == '\n') line.remove_suffix(1);
  const std::lock_guard lock(mutex_);
  if (lines_.size() >= kMost) return;
  if (!lines_.empty()) lines_ += "; ";
  lines_ += line;
}

std::string LibraryLog::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(lines_, {});
}

}  // namespace sgs::cameras
