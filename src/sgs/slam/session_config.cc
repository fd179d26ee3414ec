// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/session_config.h"

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

}  // namespace sgs::slam
