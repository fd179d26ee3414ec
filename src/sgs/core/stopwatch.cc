// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/stopwatch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <new>

namespace sgs {

double wall_time_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double thread_cpu_time_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void StageTimes::add(const std::string& name, double milliseconds) {
  stages_[name].push_back(milliseconds);
}

void StageTimes::add_interval(const std::string& name, double start_s, double milliseconds) {
  try {
    add(name, milliseconds);
    add_trace_only(name, start_s, milliseconds);
  } catch (const std::bad_alloc&) {  // a missing time is better than the end of the run
  }
}

void StageTimes::add_trace_only(const std::string& name, double start_s, double milliseconds) {
  intervals_.push_back({name, thread_, start_s, milliseconds});
}

void StageTimes::merge(const StageTimes& other) {
  intervals_.insert(intervals_.end(), other.intervals_.begin(), other.intervals_.end());
  for (const auto& [name, values] : other.stages_) {
    auto& mine = stages_[name];
    mine.insert(mine.end(), values.begin(), values.end());
  }
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(std::floor(position));
  const auto high = std::min(low + 1, values.size() - 1);
  const double fraction = position - static_cast<double>(low);
  return values[low] + fraction * (values[high] - values[low]);
}

}  // namespace sgs
