// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sgs {

/// Seconds on a monotonic clock; only differences mean anything.
double wall_time_s();
/// CPU seconds used by the calling thread.
double thread_cpu_time_s();

/// Durations collected per named stage, in memory that ends somewhere however long a run takes. Not
/// thread-safe: one per thread, merged at the end.
class StageTimes {
 public:
  /// The observations of a stage.
  struct Stage {
    std::size_t calls = 0;
    double total_ms = 0;
    /// All of them, in order of arrival; of more than kMostValues every second, fourth, ...
    std::vector<double> values_ms;
    std::size_t stride = 1;  ///< of the observations in values_ms
  };
  static constexpr std::size_t kMostValues = std::size_t{1} << 14;

  /// One observation's place in time.
  struct Interval {
    std::string_view stage;
    std::string_view thread;  ///< of the StageTimes that it was added to
    double start_s = 0;       ///< as wall_time_s()
    double duration_ms = 0;
  };
  static constexpr std::size_t kMostIntervals = std::size_t{1} << 17;  ///< the newest ones: 3 MB

  /// `thread` names the thread that the observations belong to.
  explicit StageTimes(std::string thread = "") : thread_(std::move(thread)) {}

  /// Adds one observation (milliseconds) to stage `name`; '/' in names separates levels of a tree.
  void add(const std::string& name, double milliseconds);
  /// The same, and remembers when it was; left out where the memory is used up.
  void add_interval(const std::string& name, double start_s, double milliseconds);
  /// Remembers an interval without counting it as an observation.
  void add_trace_only(const std::string& name, double start_s, double milliseconds);
  /// Appends all of another thread's observations.
  void merge(const StageTimes& other);
  /// All observations of each stage.
  const std::map<std::string, Stage>& stages() const { return stages_; }
  /// Those with a place in time, in order of arrival within each thread. Names are valid as long as
  /// this object.
  std::vector<Interval> intervals() const;

 private:
  struct Place {
    double start_s;
    float duration_ms;
    std::uint16_t stage, thread;  // in numbers_
  };
  std::uint16_t number_of(const std::string& name);
  void note(const Place& place);

  std::string thread_;
  std::map<std::string, Stage> stages_;
  std::map<std::string, std::uint16_t> numbers_;
  std::deque<Place> places_;
};

/// Measures the wall time of a scope and adds it to a StageTimes.
class ScopedTimer {
 public:
  ScopedTimer(StageTimes& times, std::string name)
      : times_(times), name_(std::move(name)), start_s_(wall_time_s()) {}
  ~ScopedTimer() { times_.add_interval(name_, start_s_, 1e3 * (wall_time_s() - start_s_)); }
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
