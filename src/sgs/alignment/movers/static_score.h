// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/alignment/movers/depth_segments.h"

namespace sgs::alignment {

constexpr float kUnknownStill = -1;  ///< score of which nobody knows anything

/// How sure it is that each cell stands still, 0 (moves) .. 1, or kUnknownStill. Segments are
/// scored as a whole: by how far their cells are `off` (SurfaceCheck::off), as those that touch
/// them, and as their cells were `before` (the scores of the frame before, empty: unknown). A cell
/// of which nothing is measured is in none: it is what its own `off` says, else what it was before.
/// (One score a cluster, smoothed over neighbours and time: Scona et al., StaticFusion, ICRA 2018.)
std::vector<float> score_still(const DepthSegments& segments, const std::vector<float>& off,
                               const std::vector<float>& before);

}  // namespace sgs::alignment
