// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/geometry/se3.h"

namespace sgs {

/// A camera pose that has been estimated anew.
struct MovedPose {
  double timestamp_s = 0;
  SE3 before, after;  ///< T_world_camera
};

/// How the estimated past of a camera has changed, as some poses in rising time order tell. What
/// else was estimated with the camera - other frames, points seen from them - moves along.
class PoseCorrection {
 public:
  PoseCorrection() = default;
  explicit PoseCorrection(std::vector<MovedPose> poses);

  bool empty() const { return poses_.empty(); }
  const std::vector<MovedPose>& poses() const { return poses_; }
  /// Where a camera that was held to be at `T_world_camera` at that time is now: moved as the poses
  /// next to it in time are, interpolated between the two, and as the first or last beyond them.
  SE3 corrected(const SE3& T_world_camera, double timestamp_s) const;
  /// By how much the camera moves where it moves most.
  double largest_translation_m() const;
  double largest_rotation_rad() const;

 private:
  std::vector<MovedPose> poses_;
};

}  // namespace sgs
