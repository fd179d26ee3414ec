// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "sgs/backend/calibrate_depth.h"
#include "sgs/input/input.h"
#include "sgs/run/track_only.h"
#include "sgs/runfolder/run_folder.h"
#include "sgs/slam/session_config.h"

namespace sgs::run {

/// Tracks an input as it is, keeps keyframes, and estimates what is wrong with its depth camera
/// (docs/calibration.md). `watch`, where given, is called after each frame. Fails as track_only()
/// does; a recording that does not tell is no failure: the estimate's why_not says so.
Result<backend::DepthEstimate> calibrate(Input& input, const slam::SessionConfig& config,
                                         const TrackedFrame& watch,
                                         const std::stop_token& stop = {});

/// Calibrates an input from itself: writes what was found into the folder, puts that file into
/// `spec` and opens the input again with it. An input that tells nothing stays as it is, with a
/// line in the log. Other arguments as for calibrate().
Status calibrate_first(InputSpec& spec, Input& input, const slam::SessionConfig& config,
                       int threads, RunFolder& folder, const TrackedFrame& watch,
                       const std::stop_token& stop = {});

}  // namespace sgs::run
