// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/features/visual_map.h"
#include "sgs/geometry/pose_correction.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Finds the camera again after it was lost: ORB features of the newest visual keyframes, matched
/// without a prediction. Features are extracted only when they are needed, so that a run that is
/// never lost never pays for them.
class Relocaliser {
 public:
  explicit Relocaliser(const RelocaliserConfig& config) : config_(config) {}

  /// Remembers a keyframe (colour and depth are copied); the oldest makes room.
  void add_keyframe(const RgbdFrame& frame, const SE3& T_local_camera);
  /// Moves the remembered keyframes (in local coordinates).
  void correct(const PoseCorrection& correction);
  /// Pose of a frame among the remembered keyframes, camera to local; empty when none fits.
  std::optional<SE3> relocalise(const RgbdFrame& frame) const;

 private:
  struct Keyframe {
    RgbdFrame frame;
    SE3 T_local_camera;
  };
  RelocaliserConfig config_;
  std::deque<Keyframe> keyframes_;
};

}  // namespace sgs::tracker
