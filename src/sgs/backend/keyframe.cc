// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/keyframe.h"

#include <algorithm>
#include <cmath>

namespace sgs::backend {

double view_distance(const Keyframe& from, const SE3& T_world_to) {
  const PinholeCamera& camera = from.gray.level(0).camera;
  const SE3 T = from.T_world_camera.inverse() * T_world_to;
  const Eigen::Vector3d centre = T * Eigen::Vector3d(0, 0, from.mean_depth_m);
  constexpr double kNear_m = 0.2, kFarAway = 9;
  if (centre.z() < kNear_m) return kFarAway;
  const double shift = std::hypot(centre.x() / centre.z() * camera.fx / camera.width,
                                  centre.y() / centre.z() * camera.fy / camera.height);
  const double roll = std::acos(std::clamp(T.R(1, 1), -1.0, 1.0));
  return shift + 0.5 * T.t.norm() / from.mean_depth_m + 0.5 * roll;
}

}  // namespace sgs::backend
