// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/depth_stamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sgs::dataset {
namespace {

constexpr double kMost_s = 0.05;
constexpr double kMillisecond = 1e-3;

std::string in_words(const DepthDelays& d) {
  return fmt::format("{:.1f} ms after its colour in the median ({:.1f} to {:.1f} ms)",
                     d.median_s / kMillisecond, d.least_s / kMillisecond, d.most_s / kMillisecond);
}

}  // namespace

std::optional<DepthDelays> summarize_delays(std::vector<double> delays_s) {
  std::sort(delays_s.begin(), delays_s.end());
  if (delays_s.empty() || (delays_s.front() == 0 && delays_s.back() == 0)) return std::nullopt;
  return DepthDelays{delays_s.front(), delays_s[delays_s.size() / 2], delays_s.back()};
}

std::optional<std::string> implausible_delays(const std::vector<double>& delays_s,
                                              const std::vector<double>& depth_times_s) {
  const auto delays = summarize_delays(delays_s);
  if (!delays) return std::nullopt;
  const auto [first, last] = std::minmax_element(depth_times_s.begin(), depth_times_s.end());
  constexpr std::size_t kFew = 3;
  const bool still = delays_s.size() >= kFew && *first == *last;
  if (!still && std::abs(delays->median_s) <= kMost_s) return std::nullopt;
  return fmt::format(
      "depth is stamped {}{}: not the clock of colour, so depth is taken as of its colour's time. "
      "If the cameras do have a lag, give it as delay_s in a file for --calibration; else "
      "stamp both with one clock",
      in_words(*delays), still ? ", all with the same time" : "");
}

}  // namespace sgs::dataset
