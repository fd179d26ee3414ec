// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/backend/calibrate_depth.h"

namespace sgs::backend {

/// calibrate_depth(), and whether the recording stands by it. Two pairs of halves, the first and
/// the second one, and stretches taken in turns, are calibrated each on its own:
/// - a part that the halves of a pair say differently (agreement.h) is held at nothing and the rest
///   estimated again; `contradicted` names it. Deviations are at least half of the difference.
/// - each half of the second pair must fit better with what the other one says than without it;
/// - pictures and depth must agree on the metre (metre.h).
/// Otherwise `refused` says why; so it does where every part is contradicted. Costs four times as
/// much as calibrate_depth().
DepthEstimate calibrate_surely(const std::vector<Keyframe>& keyframes, const history::Path& path,
                               double readout_s, const CalibrationConfig& config);

}  // namespace sgs::backend
