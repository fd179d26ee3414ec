// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/turned_map.h"

#include <utility>
#include <vector>

#include "sgs/render/view_color.h"

namespace sgs::run {

void move_into(const SE3& T_new_old, map::SplatMap& map) {
  const Eigen::Quaterniond q_new_old = T_new_old.quaternion();
  for (map::Gaussian& g : map.gaussians) {
    const Eigen::Vector3d mean = T_new_old * Eigen::Vector3d(g.mean[0], g.mean[1], g.mean[2]);
    const Eigen::Quaterniond q =
        q_new_old * Eigen::Quaterniond(g.rotation[0], g.rotation[1], g.rotation[2], g.rotation[3]);
    for (int i = 0; i < 3; ++i) g.mean[i] = static_cast<float>(mean[i]);
    g.rotation[0] = static_cast<float>(q.w());
    g.rotation[1] = static_cast<float>(q.x());
    g.rotation[2] = static_cast<float>(q.y());
    g.rotation[3] = static_cast<float>(q.z());
  }
  render::turn_harmonics(T_new_old.R, map.harmonics);
}

Trajectory moved_into(const SE3& T_new_old, const Trajectory& poses) {
  std::vector<StampedPose> moved = poses.poses();
  for (StampedPose& pose : moved) pose.T_world_camera = T_new_old * pose.T_world_camera;
  return Trajectory(std::move(moved));
}

}  // namespace sgs::run
