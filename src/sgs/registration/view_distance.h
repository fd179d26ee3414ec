// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"

namespace sgs::registration {

/// How far two views are apart (docs/method.md, section 5): the shift of the view's centre in image
/// widths, plus half the distance in mean depths, plus half the roll in radians. 0 = the same view;
/// what one sees the other does not at about 1. `mean_depth_m` is that of the view called `a`.
double view_distance(const PinholeCamera& camera, double mean_depth_m, const SE3& T_a_b);

/// Mean of an image's depths below `max_depth_m`, from an even sample; 0 where there is none.
double mean_depth(const DepthImage& depth, double max_depth_m);

}  // namespace sgs::registration
