// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sgs/run/frame_recorder.h"
#include "sgs/slam/scene_watch.h"

namespace sgs::run {

/// How a run that goes on fares beside what its frames say.
struct LiveStatus {
  struct Warning {
    slam::SceneWarning what;
    std::string text;
    bool operator==(const Warning&) const = default;
  };
  bool at_camera_rate = false;    ///< frames that come too fast are dropped
  std::int64_t dropped = 0;       ///< of those
  std::int64_t left_out = 0;      ///< came while the run was held
  double camera_fps = kNone;      ///< frames per second that come
  double track_ms = kNone;        ///< what a frame takes of late
  std::vector<Warning> warnings;  ///< in force
  RecordingStatus recording;
  std::string trouble;  ///< what the input suffers from; empty: nothing
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

/// What came of a wish to save what there is.
struct SaveNote {
  bool done = false;
  std::filesystem::path folder;  ///< where map.ply and trajectory.txt lie
  std::string text;              ///< in a sentence
};

}  // namespace sgs::run
