// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/time_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sgs::dataset {
namespace {

constexpr double kGuessedFps = 30;

struct Known {
  const char* name;
  double per_second;
};
constexpr Known kUnits[] = {{"milliseconds", 1e3}, {"microseconds", 1e6}, {"nanoseconds", 1e9}};

}  // namespace

double median_step(const std::vector<double>& sorted) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] > sorted[i - 1]) steps.push_back(sorted[i] - sorted[i - 1]);
  }
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

bool steps_evenly(const std::vector<double>& sorted) {
  constexpr std::size_t kFewest = 10;
  constexpr double kTolerance = 0.1, kMost = 0.9;
  const double step = median_step(sorted);
  if (sorted.size() < kFewest || step == 0) return false;
  std::size_t even = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    even += std::abs(sorted[i] - sorted[i - 1] - step) <= kTolerance * step ? 1 : 0;
  }
  return static_cast<double>(even) >= kMost * static_cast<double>(sorted.size() - 1);
}

TimeUnit unit_of_times(std::vector<double> times, bool whole) {
  // Cameras deliver between a thousand and one image in two seconds.
  constexpr double kShortest_s = 0.001, kLongest_s = 2;
  constexpr double kLongestView_s = 3600;  // between single views
  constexpr double kLatestYear_s = 1e10;   // seconds since 1970: some three centuries
  constexpr double kEarliestYear_s = 1e8;  // 1973
  constexpr std::size_t kFewest = 3;
  if (times.size() < kFewest) return {};
  std::sort(times.begin(), times.end());
  const double step = median_step(times), size = std::abs(times.back());
  if (step == 0) return {};
  const bool no_seconds = size > kLatestYear_s;
  if (!no_seconds && whole && step == 1 && size < kEarliestYear_s) {
    return {kGuessedFps, "frame numbers", false};
  }
  // Every second, fifth, ... frame of a camera: no camera delivers so many a second.
  constexpr double kMostSkipped = 7;
  if (!no_seconds && whole && step <= kMostSkipped && step > kLongest_s && size < kEarliestYear_s) {
    return {kGuessedFps, "frame numbers", false};
  }
  // Of Windows and .NET, since 1601 or the year 1: a camera would deliver 3000 images a second if
  // they were nanoseconds.
  constexpr double kTicks = 1e7, kFirstTick = 1e17, kLastTick = 9e17;
  if (size > kFirstTick && size < kLastTick && step / kTicks >= kShortest_s &&
      step / kTicks <= kLongest_s && step / 1e9 < kShortest_s) {
    return {kTicks, "ticks of 100 nanoseconds", true};
  }
  for (const Known& unit : kUnits) {
    const double size_s = size / unit.per_second, step_s = step / unit.per_second;
    const bool since_1970 = no_seconds && size_s > kEarliestYear_s && size_s < kLatestYear_s;
    // What a clock that began with the device counts may be as large in another unit.
    if (since_1970 && step_s < kLongestView_s) return {unit.per_second, unit.name, true};
  }
  // Seconds that are written with their fractions may be far apart: single views.
  if (!no_seconds && (!whole || step <= kLongest_s)) return {};
  for (const Known& unit : kUnits) {
    const double step_s = step / unit.per_second;
    if (step_s >= kShortest_s && step_s < 1) return {unit.per_second, unit.name, true};
  }
  return {};
}

bool is_no_pause(double gap_s) {
  constexpr double kDay_s = 86400;
  return gap_s > kDay_s;
}

std::string clock_set_ahead(double before_s, double after_s) {
  return fmt::format(
      "the clock was set ahead by {:.0f} s behind {:.3f} s; images and times are taken as they are",
      after_s - before_s, before_s);
}

}  // namespace sgs::dataset
