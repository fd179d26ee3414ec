// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/camera/pyramid.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/history/path.h"
#include "sgs/registration/inverse_depth_field.h"
#include "sgs/registration/view_distance.h"

namespace sgs::backend {

/// A pixel of a keyframe whose place in the world is estimated along with the poses.
struct HostPixel {
  double u = 0, v = 0;       ///< of the colour image
  double inverse_depth = 0;  ///< 1/m, as measured
};

/// What the back end keeps of a keyframe: the picture, the raw depth, and how the camera moved.
/// Where it is, the path says.
struct Keyframe {
  std::int64_t frame = 0;  ///< index in the sequence
  double timestamp_s = 0;
  Vector6d velocity = Vector6d::Zero();  ///< camera twist per second, rotation first
  double depth_delay_s = 0;              ///< of its depth after its colour, as stamped
  double mean_depth_m = 0;
  GrayPyramid gray;
  registration::InverseDepthField inverse_depth;
  std::vector<HostPixel> pixels;
};

/// registration::view_distance() from a keyframe to another camera.
inline double view_distance(const Keyframe& from, const SE3& T_from_to) {
  return registration::view_distance(from.gray.level(0).camera, from.mean_depth_m, T_from_to);
}

/// A keyframe and where it is held to be: of the middle row.
struct PlacedKeyframe {
  const Keyframe* keyframe = nullptr;
  SE3 T_odom_camera;

  const Keyframe* operator->() const { return keyframe; }
};
/// In order of time; whoever holds the keyframes keeps them alive.
using KeyframeList = std::vector<PlacedKeyframe>;

}  // namespace sgs::backend
