// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/camera/pyramid.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/inverse_depth_field.h"
#include "sgs/registration/view_distance.h"

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
  double depth_delay_s = 0;              ///< of its depth after its colour, as stamped
  double mean_depth_m = 0;
  GrayPyramid gray;
  registration::InverseDepthField inverse_depth;
  std::vector<HostPixel> pixels;
};

/// registration::view_distance() from a keyframe to another pose.
inline double view_distance(const Keyframe& from, const SE3& T_world_to) {
  return registration::view_distance(from.gray.level(0).camera, from.mean_depth_m,
                                     from.T_world_camera.inverse() * T_world_to);
}

}  // namespace sgs::backend
