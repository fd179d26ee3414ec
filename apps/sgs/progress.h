// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace sgs::app {

/// Progress on stderr: a bar that rewrites itself on a terminal, a plain line every few seconds
/// otherwise.
class Progress {
 public:
  Progress(std::string what, std::optional<std::int64_t> total, bool quiet);
  /// One more is done; `detail` (status, counts) is shown behind the numbers.
  void step(const std::string& detail);
  /// Ends the bar's line.
  void finish();

 private:
  void show(const std::string& detail);

  std::string what_;
  std::optional<std::int64_t> total_;
  bool quiet_, terminal_;
  std::int64_t done_ = 0;
  double start_s_, last_shown_s_ = 0;
  bool line_open_ = false;
};

}  // namespace sgs::app
