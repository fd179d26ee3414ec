// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>

#include "sgs/camera/depth_change.h"
#include "sgs/geometry/pose_correction.h"

namespace sgs {

/// What has become known of the past since it was recorded: where the camera was, and what its
/// depth should have been. Everything that remembers frames follows it.
struct PastCorrection {
  PastCorrection() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a correction of poses is one of the past.
  PastCorrection(PoseCorrection corrected_poses) : poses(std::move(corrected_poses)) {}
  PastCorrection(PoseCorrection corrected_poses, std::shared_ptr<const DepthChange> change)
      : poses(std::move(corrected_poses)), depth(std::move(change)) {}

  PoseCorrection poses;
  std::shared_ptr<const DepthChange> depth;  ///< null: depth is as it was held to be

  /// Where a camera is now that was held to be at `T_world_camera` at that time.
  SE3 corrected(const SE3& T_world_camera, double timestamp_s) const {
    return poses.corrected(T_world_camera, timestamp_s);
  }
  /// The same told in other coordinates of the world.
  PastCorrection in_frame(const SE3& T_frame_world) const {
    return {poses.in_frame(T_frame_world), depth};
  }
};

}  // namespace sgs
