// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/geometry/archive_se3.h"
#include "sgs/history/path.h"

namespace sgs::slam {

/// A mapping keyframe in the refined map. Its world and `odom`, that of the tracker, in which the
/// path tells where the keyframe is, start as one. A tracker that follows points of its own drifts
/// away from the map when its keyframes are refined; one that follows the map does not.
struct KeyframePose {
  std::int64_t frame_index = 0;
  double timestamp_s = 0;
  SE3 T_world_camera;  ///< as the mapper has it now

  template <class Archive>
  void archive(Archive& a) {
    a(frame_index, timestamp_s, T_world_camera);
  }
};

/// Where the tracker's world lies in the map's, as a keyframe shows it.
inline SE3 T_world_odom(const KeyframePose& keyframe, const history::Path& path) {
  return keyframe.T_world_camera * path.at(keyframe.frame_index).inverse();
}

/// What refinement has made of the tracker's world: carries tracked poses into the map's.
/// `keyframes` must be in increasing time order.
inline PoseCorrection odom_to_world(const std::vector<KeyframePose>& keyframes,
                                    const history::Path& path) {
  std::vector<MovedPose> poses;
  poses.reserve(keyframes.size());
  for (const KeyframePose& k : keyframes) {
    poses.push_back({k.timestamp_s, path.at(k.frame_index), k.T_world_camera});
  }
  return PoseCorrection(std::move(poses));
}

}  // namespace sgs::slam
