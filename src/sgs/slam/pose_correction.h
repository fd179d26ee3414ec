// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/geometry/se3.h"

namespace sgs::slam {

/// A mapping keyframe: where it was when it entered the map and where refinement has moved it.
struct KeyframePose {
  std::int64_t frame_index = 0;
  double timestamp_s = 0;
  SE3 T_world_tracked;   ///< as the tracker saw it, in the tracker's world
  SE3 T_world_inserted;  ///< as it was given to the mapper
  SE3 T_world_refined;   ///< as the mapper has it now
};

/// Carries tracked poses into the refined map: each keyframe's correction
/// C = T_refined * T_tracked^-1 acts on the frames near it, interpolated in time between
/// neighbouring keyframes and held constant before the first and after the last one.
/// `keyframes` must be in increasing time order.
SE3 corrected_pose(const SE3& T_world_tracked, double timestamp_s,
                   const std::vector<KeyframePose>& keyframes);

}  // namespace sgs::slam
