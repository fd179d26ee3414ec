// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/backend/bundle.h"

namespace sgs::backend {

/// Those that show enough contrast on measured surfaces, where the path has them.
KeyframeList useful_keyframes(const std::vector<Keyframe>& all, const history::Path& path);
/// Thinned evenly if there are more than `most`.
KeyframeList thinned(const KeyframeList& keyframes, int most);

/// Bundle adjustment of all of the keyframes given: which see which, and a start as they are placed
/// and measured, corrected by `known` where that is given (of the configured grid).
Bundle make_bundle(const KeyframeList& keyframes, double readout_s, const CalibrationConfig& config,
                   const DepthCalibration* known = nullptr);

}  // namespace sgs::backend
