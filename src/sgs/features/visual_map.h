// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/features/visual_pose.h"

namespace sgs::features {

/// ORB points of keyframes with their measured depth, kept in the keyframe's camera so that a
/// keyframe can be moved. Not thread-safe. Memory grows by about 150 kB per keyframe.
class VisualMap {
 public:
  explicit VisualMap(const VisualPoseConfig& config) : config_(config) {}

  /// Returns the index of the new keyframe.
  int insert(OrbFrame frame, const SE3& T_world_keyframe);
  void set_pose(int keyframe, const SE3& T_world_keyframe);
  int size() const { return static_cast<int>(keyframes_.size()); }

  /// Points of the last keyframes, searched for around their projection at `T_predicted` and
  /// refined into a pose (reprojection with sigma = scale^octave px, and depth). The current frame
  /// matches each of its features at most once per keyframe.
  VisualPose localise(const OrbFrame& current, const SE3& T_predicted) const;

  /// Pose without a prediction: descriptors against the newer half of the allowed keyframes and an
  /// even choice of the older ones, PnP on those `tried` that have most alike, refinement; the
  /// most inliers win.
  VisualPose relocalise(const OrbFrame& current, std::size_t tried = 3) const;

 private:
  struct Keyframe {
    OrbFrame frame;
    SE3 T_world_keyframe;
  };
  Observation observe(const Keyframe& keyframe, int point, const OrbFrame& current,
                      int feature) const;
  std::vector<int> relocalisation_candidates() const;
  VisualPoseConfig config_;
  std::vector<Keyframe> keyframes_;
};

}  // namespace sgs::features
