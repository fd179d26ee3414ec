// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sgs/backend/calibrate_depth.h"

namespace sgs::backend {

/// By how much a path grows, about its middle, when its poses are corrected.
double scale_of(const std::vector<MovedPose>& poses);

/// Two cameras that do not belong together look like a distorted one, but for this: pictures and
/// depth disagree on the metre. A sentence where the path's scale changes by `scale`, more than
/// 1.5 %, and depth itself by more than 0.75 %: a depth camera that is off by more is not a little
/// distorted but something else. A path alone may be: distortion that varies over the image bends
/// it. `keyframes`: from which the estimate was made.
std::optional<std::string> metre_contradiction(const DepthEstimate& estimate, double scale,
                                               const std::vector<Keyframe>& keyframes);

}  // namespace sgs::backend
