// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/camera/pyramid.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/inverse_depth_field.h"

namespace sgs::backend {

/// A pixel of a keyframe whose place in the world is estimated along with the poses.
struct HostPixel {
  double u = 0, v = 0;       ///< of the colour image
  double inverse_depth = 0;  ///< 1/m, as measured
};

/// What the back end keeps of a keyframe: the picture, the raw depth, and how the camera moved.
struct Keyframe {
  std::int64_t frame = 0;  ///< index in the sequence
  double timestamp_s = 0;
  SE3 T_world_camera;                    ///< of the middle row
  Vector6d velocity = Vector6d::Zero();  ///< camera twist per second, rotation first
  double mean_depth_m = 0;
  GrayPyramid gray;
  registration::InverseDepthField inverse_depth;
  std::vector<HostPixel> pixels;
};

/// How far two views of a scene are apart: the shift of the image's centre in image widths, plus
/// half the distance in mean depths, plus half the roll in radians (0 = the same view; what one
/// sees the other does not at about 1).
double view_distance(const Keyframe& from, const SE3& T_world_to);

}  // namespace sgs::backend
