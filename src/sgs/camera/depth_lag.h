// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pinhole.h"
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

}  // namespace sgs
