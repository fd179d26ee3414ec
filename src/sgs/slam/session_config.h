// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "sgs/camera/heldout.h"
#include "sgs/core/config.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::slam {

/// Everything that decides what a run computes. Same input, config and seed: same bits.
struct SessionConfig {
  std::string preset = "default";  ///< where the values came from; set by make_session_config()
  std::uint64_t seed = 0;          ///< of every random choice
  int keyframe_interval = 8;       ///< a mapping keyframe at least every so many frames
  int heldout_interval =
      kHeldoutInterval;        ///< every n-th frame is never used by the mapper; 0 = none
  int snapshot_lag = 2;        ///< k: frame t is tracked against the map after frame t - k
  int snapshot_interval = 10;  ///< a new snapshot at least every so many frames
  tracker::TrackerConfig tracker;
  mapper::MapperConfig mapper;

  void declare(ParameterList& list);
};

/// The named preset: "default" (ours) or "paper" (docs/method.md, column "paper").
Result<SessionConfig> make_session_config(const std::string& preset);

}  // namespace sgs::slam
