// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/pinhole.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// What is to be added to the inverse depth `q` measured on the ray (x, y, 1) of a camera to have
/// it for the moment when the colour was seen, where the camera moved by the twist `lag` from
/// colour to depth: the surface on the ray was seen a little beside it, and it was nearer or
/// farther. `slope`: of inverse depth per pixel. To first order.
inline float depth_lag_per_m(const PinholeCamera& camera, const Eigen::Vector3f& ray, float q,
                             const Eigen::Vector2f& slope, const Vector6d& lag) {
  const Eigen::Vector3f turn = lag.head<3>().cast<float>(), move = lag.tail<3>().cast<float>();
  const Eigen::Vector3f moved = turn.cross(ray) + q * move;  // times q: of the point at ray / q
  const Eigen::Vector2f aside(static_cast<float>(camera.fx) * (moved.x() - ray.x() * moved.z()),
                              static_cast<float>(camera.fy) * (moved.y() - ray.y() * moved.z()));
  return -slope.dot(aside) - q * moved.z();
}

/// The depth that the camera would have measured when it saw the colour, of a depth image that was
/// measured after it had moved by the twist `lag` (rotation first, first order): each pixel takes
/// the measurement whose surface point lies on its ray then, nothing is mixed. 0 where there is
/// none.
DepthImage depth_with_colour(const DepthImage& depth, const PinholeCamera& camera,
                             const Vector6d& lag);

/// The frame with its depth as of its colour's time; the frame itself where `lag` is zero.
std::shared_ptr<const RgbdFrame> frame_of_one_time(const std::shared_ptr<const RgbdFrame>& frame,
                                                   const Vector6d& lag);

}  // namespace sgs
