// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/pose_correction.h"

#include <algorithm>

namespace sgs::slam {

SE3 corrected_pose(const SE3& T_odom_camera, double timestamp_s,
                   const std::vector<KeyframePose>& keyframes) {
  if (keyframes.empty()) return T_odom_camera;
  const auto after =
      std::lower_bound(keyframes.begin(), keyframes.end(), timestamp_s,
                       [](const KeyframePose& k, double time) { return k.timestamp_s < time; });
  if (after == keyframes.begin()) return T_world_odom(keyframes.front()) * T_odom_camera;
  if (after == keyframes.end()) return T_world_odom(keyframes.back()) * T_odom_camera;
  const KeyframePose& before = *std::prev(after);
  const double alpha =
      (timestamp_s - before.timestamp_s) / (after->timestamp_s - before.timestamp_s);
  // Interpolating the corrected poses instead of the corrections keeps the result independent of
  // where the world's origin lies.
  return interpolate(T_world_odom(before) * T_odom_camera, T_world_odom(*after) * T_odom_camera,
                     alpha);
}

}  // namespace sgs::slam
