// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/session_config.h"

namespace sgs::slam {

void SessionConfig::declare(ParameterList& list) {
  {
    const auto group = list.group("slam");
    list.add("preset", preset, "Preset the values started from.", {"default", "paper"});
    list.add("seed", seed, "Seed of every random choice.");
    list.add("keyframe_interval", keyframe_interval,
             "A mapping keyframe at least every so many frames.", "frames", {1, 1000});
    list.add("heldout_interval", heldout_interval,
             "Every n-th frame is kept from the mapper for evaluation; 0 uses all frames.",
             "frames", {0, 1000});
    list.add(
        "snapshot_lag", snapshot_lag,
        "Frame t is tracked against the map that the budget of frame t - k left behind, so that "
        "tracking and mapping overlap and nothing depends on timing.",
        "frames", {1, 100});
    list.add("snapshot_interval", snapshot_interval,
             "A new map snapshot at least every so many frames (keyframes always make one).",
             "frames", {1, 1000});
  }
  {
    const auto group = list.group("tracker");
    tracker.declare(list);
  }
  {
    const auto group = list.group("mapper");
    mapper.declare(list);
  }
}

Result<SessionConfig> make_session_config(const std::string& preset) {
  SessionConfig config;
  config.preset = preset;
  if (preset == "default") return config;
  if (preset == "paper") {
    config.tracker = tracker::paper_tracker_config();
    config.mapper = mapper::paper_mapper_config();
    config.keyframe_interval = 10;
    return config;
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown preset '{}'", preset),
              "use --preset default or --preset paper");
}

}  // namespace sgs::slam
