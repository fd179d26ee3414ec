// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "sgs/core/print.h"
#include "sgs/core/stopwatch.h"

namespace sgs::app {

Progress::Progress(std::string what, std::optional<std::int64_t> total, bool quiet)
    : what_(std::move(what)),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_s_(wall_time_s()) {}

void Progress::step(const std::string& detail) {
  ++done_;
  const double now_s = wall_time_s();
  const double interval_s = terminal_ ? 0.1 : 5.0;
  const bool last = total_ && done_ == *total_;
  if (quiet_ || (!last && now_s - std::max(last_shown_s_, start_s_) < interval_s)) return;
  last_shown_s_ = now_s;
  show(detail);
}

void Progress::show(const std::string& detail) {
  const double elapsed_s = std::max(1e-6, last_shown_s_ - start_s_);
  const double rate = static_cast<double>(done_) / elapsed_s;
  std::string text;
  if (total_ && *total_ > 0) {
    const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(*total_));
    if (terminal_) {
      constexpr int kWidth = 24;
      const int filled = static_cast<int>(share * kWidth);
      text = "[" + std::string(static_cast<std::size_t>(filled), '#') +
             std::string(static_cast<std::size_t>(kWidth - filled), '.') + "] ";
    }
    const double left_s = static_cast<double>(*total_ - done_) / rate;
    text += fmt::format("{}/{} {}  {:.1f}/s  ETA {:.0f} s", done_, *total_, what_, rate,
                        std::max(0.0, left_s));
  } else {
    text = fmt::format("{} {}  {:.1f}/s", done_, what_, rate);
  }
  if (!detail.empty()) text += "  " + detail;
  if (terminal_) {
    say("\r\x1b[K{}", text);
    line_open_ = true;
  } else {
    say("{}\n", text);
  }
  std::fflush(stderr);
}

void Progress::finish() {
  if (line_open_) say("\n");
  line_open_ = false;
}

}  // namespace sgs::app
