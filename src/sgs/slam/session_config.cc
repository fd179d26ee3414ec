// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/session_config.h"

#include <algorithm>

#include "sgs/tracker/tracker.h"

namespace sgs::slam {

SessionConfig make_session_config(Preset preset) {
  SessionConfig config;
  config.preset = preset;
  if (preset == Preset::kPaper) {
    config.tracker = tracker::paper_tracker_config();
    config.mapper = mapper::paper_mapper_config();
    config.keyframe_interval = 10;
    config.loops.enabled = false;
    config.backend.calibration.online = false;
  }
  if (preset == Preset::kQuality) {
    config.mapper.iterations_per_frame = 4;
    config.mapper.schedule.half_resolution_share = 0.7;
  }
  return config;
}

Result<SessionConfig> make_session_config(std::string_view preset) {
  SGS_ASSIGN_OR_RETURN(const Preset known, from_string<Preset>("preset", preset));
  return make_session_config(known);
}

SessionConfig effective(SessionConfig config, const tracker::Tracker& tracker) {
  if (!tracker.moves_keyframes()) config.mapper.refinement.pose = false;
  config.mapper.iterations_per_frame =
      std::max(config.mapper.iterations_per_frame, tracker.least_mapping_steps());
  // A tracker that follows the map would see a correction some frames late; poses that do not rest
  // on each other do not drift.
  if (tracker.follows_map() || !tracker.needs_video()) {
    config.loops.enabled = false;
    config.backend.calibration.online = false;
    config.tracker.movers.second_look = false;
  }
  return config;
}

}  // namespace sgs::slam
