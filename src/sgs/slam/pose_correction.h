// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/geometry/se3.h"

namespace sgs::slam {

/// A mapping keyframe, in two worlds that start as one: `odom`, the world of the tracker, and
/// `world`, that of the refined map. A tracker that follows points of its own drifts away from the
/// map when its keyframes are refined; one that follows the map does not.
struct KeyframePose {
  std::int64_t frame_index = 0;
  double timestamp_s = 0;
  SE3 T_odom_camera;   ///< as the tracker saw it
  SE3 T_world_camera;  ///< as the mapper has it now
};

/// Where the tracker's world lies in the map's, as a keyframe shows it.
inline SE3 T_world_odom(const KeyframePose& keyframe) {
  return keyframe.T_world_camera * keyframe.T_odom_camera.inverse();
}

/// Carries tracked poses into the refined map: each keyframe's T_world_odom acts on the frames near
/// it, interpolated in time between neighbouring keyframes and held constant before the first and
/// after the last one. `keyframes` must be in increasing time order.
SE3 corrected_pose(const SE3& T_odom_camera, double timestamp_s,
                   const std::vector<KeyframePose>& keyframes);

}  // namespace sgs::slam
