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

namespace {

/// Halves what is kept of a stage's observations.
void thin(StageTimes::Stage& stage) {
  std::vector<double>& values = stage.values_ms;
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
  stage.stride *= 2;
}

}  // namespace

void StageTimes::add(const std::string& name, double milliseconds) {
  Stage& stage = stages_[name];
  if (stage.calls % stage.stride == 0) {
    stage.values_ms.push_back(milliseconds);
    if (stage.values_ms.size() >= kMostValues) thin(stage);
  }
  ++stage.calls;
  stage.total_ms += milliseconds;
}

void StageTimes::add_interval(const std::string& name, double start_s, double milliseconds) {
  try {
    add(name, milliseconds);
    add_trace_only(name, start_s, milliseconds);
  } catch (const std::bad_alloc&) {  // a missing time is better than the end of the run
  }
}

void StageTimes::add_trace_only(const std::string& name, double start_s, double milliseconds) {
  note({start_s, static_cast<float>(milliseconds), number_of(name), number_of(thread_)});
}

std::uint16_t StageTimes::number_of(const std::string& name) {
  return numbers_.try_emplace(name, static_cast<std::uint16_t>(numbers_.size())).first->second;
}

void StageTimes::note(const Place& place) {
  if (places_.size() >= kMostIntervals) places_.pop_front();
  places_.push_back(place);
}

void StageTimes::merge(const StageTimes& other) {
  std::vector<std::uint16_t> numbers(other.numbers_.size());
  for (const auto& [name, number] : other.numbers_) numbers[number] = number_of(name);
  for (Place place : other.places_) {
    place.stage = numbers[place.stage];
    place.thread = numbers[place.thread];
    places_.push_back(place);
  }
  for (const auto& [name, theirs] : other.stages_) {
    Stage& mine = stages_[name];
    Stage added = theirs;
    while (mine.stride < added.stride) thin(mine);
    while (added.stride < mine.stride) thin(added);
    mine.values_ms.insert(mine.values_ms.end(), added.values_ms.begin(), added.values_ms.end());
    mine.calls += added.calls;
    mine.total_ms += added.total_ms;
  }
}

std::vector<StageTimes::Interval> StageTimes::intervals() const {
  std::vector<std::string_view> names(numbers_.size());
  for (const auto& [name, number] : numbers_) names[number] = name;
  std::vector<Interval> out;
  out.reserve(places_.size());
  for (const Place& p : places_) {
    out.push_back({names[p.stage], names[p.thread], p.start_s, double{p.duration_ms}});
  }
  return out;
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
