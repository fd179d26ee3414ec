// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sgs/runfolder/run.h"
#include "sgs/viewer/frame_update.h"

namespace sgs::app {

/// A finished run, ready to be shown again.
struct Replay {
  viewer::RunInfo info;
  run::InputSpec input;
  std::vector<viewer::FrameUpdate> updates;  ///< of the readable frames, in order
  eval::Metrics metrics;
  bool unfinished = false;  ///< killed or still going on
};

/// Reads a run folder; fails where no frame has a pose. Its map is number `map_version` of what is
/// shown.
Result<Replay> load_replay(const std::filesystem::path& folder, std::uint64_t map_version = 1);

}  // namespace sgs::app
