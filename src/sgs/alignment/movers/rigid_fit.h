// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/movers/coarse_depth.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/cell_mask.h"

namespace sgs::alignment {

/// The one motion of the camera that best explains a frame's depth by an older frame's, near the
/// one that is given (between_depths()). By depth alone: what depth and colour differ in
/// time, and what is wrong with the pose, is in it; what moves by itself is not, or else all the
/// rest is not. Points `without` (of the frame's picture) are not asked. Few points, few steps:
/// points to planes, robustly weighted (Geman, McClure).
SE3 fit_rigid(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now,
              const registration::CellMask& without = {});

}  // namespace sgs::alignment
