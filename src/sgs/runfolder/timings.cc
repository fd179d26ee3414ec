// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/timings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

namespace sgs::run {

namespace {

using Json = nlohmann::ordered_json;

/// Where stage `name` belongs below `root`.
Json& node_of(Json& root, const std::string& name) {
  const auto slash = name.find('/');
  if (slash == std::string::npos) return root[name];
  return node_of(root[name.substr(0, slash)]["children"], name.substr(slash + 1));
}

}  // namespace

std::string timings_json(const StageTimes& times) {
  Json root = Json::object();
  for (const auto& [name, stage] : times.stages()) {  // parents come before their parts
    Json& node = node_of(root, name);
    node["calls"] = stage.calls;
    node["total_ms"] = stage.total_ms;
    node["p50_ms"] = quantile(stage.values_ms, 0.5);
    node["p95_ms"] = quantile(stage.values_ms, 0.95);
  }
  return root.dump(2) + "\n";
}

std::string chrome_trace(const StageTimes& times, std::span<const InputEvent> happened) {
  double begin_s = std::numeric_limits<double>::infinity();
  const std::vector<StageTimes::Interval> intervals = times.intervals();
  for (const auto& interval : intervals) begin_s = std::min(begin_s, interval.start_s);
  for (const InputEvent& event : happened) begin_s = std::min(begin_s, event.wall_s);
  constexpr double kMicroseconds = 1e6, kPerMillisecond = 1e3;
  std::map<std::string, int> threads;
  Json events = Json::array();
  for (const auto& interval : intervals) {
    const auto [thread, is_new] =
        threads.try_emplace(std::string(interval.thread), static_cast<int>(threads.size()) + 1);
    if (is_new) {
      events.push_back({{"ph", "M"},
                        {"name", "thread_name"},
                        {"pid", 1},
                        {"tid", thread->second},
                        {"args", {{"name", interval.thread}}}});
    }
    events.push_back({{"ph", "X"},
                      {"name", interval.stage},
                      {"pid", 1},
                      {"tid", thread->second},
                      {"ts", std::round(kMicroseconds * (interval.start_s - begin_s))},
                      {"dur", std::round(kPerMillisecond * interval.duration_ms)}});
  }
  for (const InputEvent& event : happened) {
    events.push_back({{"ph", "i"},
                      {"s", "g"},
                      {"name", event.what},
                      {"pid", 1},
                      {"tid", 0},
                      {"ts", std::round(kMicroseconds * (event.wall_s - begin_s))}});
  }
  return Json({{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}).dump() + "\n";
}

}  // namespace sgs::run
