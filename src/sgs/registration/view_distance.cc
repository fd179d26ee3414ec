// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/view_distance.h"

#include <algorithm>
#include <cmath>

namespace sgs::registration {

double view_distance(const PinholeCamera& camera, double mean_depth_m, const SE3& T_a_b) {
  const Eigen::Vector3d centre = T_a_b * Eigen::Vector3d(0, 0, mean_depth_m);
  constexpr double kNear_m = 0.2, kFarAway = 9;
  if (centre.z() < kNear_m) return kFarAway;
  const double shift = std::hypot(centre.x() / centre.z() * camera.fx / camera.width,
                                  centre.y() / centre.z() * camera.fy / camera.height);
  const double roll = std::acos(std::clamp(T_a_b.R(1, 1), -1.0, 1.0));
  return shift + 0.5 * T_a_b.t.norm() / mean_depth_m + 0.5 * roll;
}

double mean_depth(const DepthImage& depth, double max_depth_m) {
  constexpr std::size_t kStride = 37;  // coprime to usual image widths: an even sample
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < depth.size(); i += kStride) {
    const double z = static_cast<double>(depth.data()[i]);
    if (!(z > 0 && z < max_depth_m)) continue;
    sum += z;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace sgs::registration
