// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/geometry/archive_se3.h"
#include "sgs/geometry/pose_correction.h"

namespace sgs::slam {

/// A mapping keyframe, in two worlds that start as one: `odom`, the world of the tracker, and
/// `world`, that of the refined map. A tracker that follows points of its own drifts away from the
/// map when its keyframes are refined; one that follows the map does not.
struct KeyframePose {
  std::int64_t frame_index = 0;
  double timestamp_s = 0;
  SE3 T_odom_camera;   ///< as the tracker saw it
  SE3 T_world_camera;  ///< as the mapper has it now

  template <class Archive>
  void archive(Archive& a) {
    a(frame_index, timestamp_s, T_odom_camera, T_world_camera);
  }
};

/// Where the tracker's world lies in the map's, as a keyframe shows it.
inline SE3 T_world_odom(const KeyframePose& keyframe) {
  return keyframe.T_world_camera * keyframe.T_odom_camera.inverse();
}

/// What refinement has made of the tracker's world: carries tracked poses into the map's.
/// `keyframes` must be in increasing time order.
inline PoseCorrection odom_to_world(const std::vector<KeyframePose>& keyframes) {
  std::vector<MovedPose> poses;
  poses.reserve(keyframes.size());
  for (const KeyframePose& k : keyframes) {
    poses.push_back({k.timestamp_s, k.T_odom_camera, k.T_world_camera});
  }
  return PoseCorrection(std::move(poses));
}

}  // namespace sgs::slam
