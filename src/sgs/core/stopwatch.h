// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

namespace sgs {

/// Seconds on a monotonic clock; only differences mean anything.
double wall_time_s();
/// CPU seconds used by the calling thread.
double thread_cpu_time_s();

/// Durations collected per named stage. Not thread-safe: one per thread, merged at the end.
class StageTimes {
 public:
  /// Adds one observation (milliseconds) to stage `name`; '/' in names separates levels of a tree.
  void add(const std::string& name, double milliseconds);
  /// Appends all of another thread's observations.
  void merge(const StageTimes& other);
  /// All observations of each stage, in order of arrival.
  const std::map<std::string, std::vector<double>>& stages() const { return stages_; }

 private:
  std::map<std::string, std::vector<double>> stages_;
};

/// Measures the wall time of a scope and adds it to a StageTimes.
class ScopedTimer {
 public:
  ScopedTimer(StageTimes& times, std::string name)
      : times_(times), name_(std::move(name)), start_s_(wall_time_s()) {}
  ~ScopedTimer() { times_.add(name_, 1e3 * (wall_time_s() - start_s_)); }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  StageTimes& times_;
  std::string name_;
  double start_s_;
};

/// Order statistic of unsorted values, linearly interpolated; `q` in [0, 1]. NaN when empty.
double quantile(std::vector<double> values, double q);

}  // namespace sgs
