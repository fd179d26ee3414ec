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

/// By how much depth itself is off, as a share of it: in the mean over the image.
double mean_depth_share(const DepthCalibration& calibration, const std::vector<Keyframe>& seen);
/// The same as the root of the mean square over the image.
double rms_depth_share(const DepthCalibration& calibration, const std::vector<Keyframe>& seen);

/// Two cameras that do not belong together look like a distorted one, but for this: pictures and
/// depth disagree on the metre. A sentence where the path's scale changes by `scale`, more than
/// 1.5 %, and depth itself by a `share` of more than 0.75 %: a depth camera that is off by more is
/// not a little distorted but something else. A path alone may be: distortion that varies over the
/// image bends its first metres.
std::optional<std::string> metre_contradiction(const DepthEstimate& estimate, double scale,
                                               double share);

}  // namespace sgs::backend
