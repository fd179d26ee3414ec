// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/eval/metrics.h"
#include "sgs/map/gaussian.h"
#include "sgs/slam/frame_record.h"

namespace sgs::viewer {

/// What never changes while a server runs; the first message to each client.
struct RunInfo {
  std::string version, input, tracker, preset;
  bool live = true;      ///< a run in progress; false: the replay of a finished one
  bool refines = false;  ///< the page offers to refine the map
  PinholeCamera camera;
  std::optional<std::int64_t> frames_total;
  std::optional<Eigen::Vector3d> up = {};  ///< unit, in the world of the map, where it is known
  bool session = false;                    ///< the page offers to finish and to save
  bool records = false;                    ///< and to record
  bool starts_again = false;               ///< and to start again
};

/// Everything there is to show about one tracked frame. Immutable once posted.
struct FrameUpdate {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  slam::FrameRecord record;
  SE3 T_world_camera;        ///< in the world of the map (keyframe refinement included)
  std::optional<SE3> truth;  ///< moved into the same world
  map::SnapshotPtr map;      ///< newest at that time; null before the first keyframe
  std::shared_ptr<const RgbdFrame> frame;  ///< null where the images are not at hand
  double map_ms = kNone;                   ///< time the mapper was busy since the last frame
  double fps = kNone;                      ///< frames per second lately
  bool finished = false;                   ///< nothing comes after this one; `map` is final
};

/// What is known of a run once it is finished.
struct FinalWord {
  eval::Metrics metrics;
  std::optional<Eigen::Vector3d> up = {};  ///< unit, in the world of the map, where it is known
};

/// How a run that goes on fares beside its frames, and what became of what clients wished.
struct SessionNote {
  struct Warning {
    std::string key, text;
  };
  bool at_camera_rate = false;             ///< frames that come too fast are dropped
  std::int64_t dropped = 0;                ///< of those
  std::int64_t left_out = 0;               ///< came while the run was held
  double camera_fps = FrameUpdate::kNone;  ///< frames that come per second
  std::string why_dropped;                 ///< in a sentence; empty where nothing is dropped
  std::vector<Warning> warnings;           ///< to whoever holds the camera
  std::string trouble;                     ///< what the input suffers from; empty: nothing
  bool recording = false;
  std::string recorded;                ///< what has been recorded, in words; empty: nothing
  std::string recording_trouble;       ///< in a sentence; empty: nothing
  std::string saved;                   ///< what the last save came to; empty: there was none
  bool refinable = false;              ///< its frames are kept: the map can be refined at the end
  bool ended = false;                  ///< the run and its results are complete
  std::vector<std::string> downloads;  ///< names below /download/
};

/// How the refinement that the page asked for fares.
struct RefinementNote {
  bool running = false;
  double share = 0;  ///< of the budget, 0..1
  std::string text;  ///< what to tell
};

using FrameUpdatePtr = std::shared_ptr<const FrameUpdate>;

}  // namespace sgs::viewer
