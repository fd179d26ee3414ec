// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "run_request.h"
#include "sgs/viewer/frame_update.h"

namespace sgs::app {

/// A finished run, ready to be shown again.
struct Replay {
  viewer::RunInfo info;
  InputSpec input;
  std::vector<viewer::FrameUpdate> updates;  ///< of the readable frames, in order
  map::SnapshotPtr map;
  std::string metrics_json;  ///< empty when the run was not scored
};

/// Reads config.toml, frames.csv, trajectory.txt and map.ply of a run folder; groundtruth.txt and
/// metrics.json where they exist.
Result<Replay> load_replay(const std::string& folder);

}  // namespace sgs::app
