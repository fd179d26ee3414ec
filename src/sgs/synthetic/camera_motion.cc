// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/camera_motion.h"

#include <cmath>

namespace sgs::synthetic {

Trajectory moved_otherwise(const Trajectory& motion, const Trajectory& whole, CameraMotion how) {
  constexpr double kFarthest_rad = 0.6, kPeriod_s = 6, kNod_rad = 0.08, kNodPeriod_s = 4;
  const auto& poses = whole.poses();
  const SE3 middle = poses[poses.size() / 2].T_world_camera;
  const double start_s = poses.front().timestamp_s;
  Trajectory out;
  for (const StampedPose& pose : motion.poses()) {
    SE3 T = middle;
    if (how == CameraMotion::kTurning) {
      const double t = 2 * M_PI * (pose.timestamp_s - start_s);
      const double yaw = kFarthest_rad * std::sin(t / kPeriod_s);
      const double nod = kNod_rad * std::sin(t / kNodPeriod_s);
      T.R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix() * middle.R *
            Eigen::AngleAxisd(nod, Eigen::Vector3d::UnitX()).toRotationMatrix();
    }
    out.push_back({pose.timestamp_s, T});
  }
  return out;
}

}  // namespace sgs::synthetic
