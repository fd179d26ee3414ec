// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/features/visual_map.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// Features alone: ORB points of the last keyframes with their measured depth, searched for around
/// the constant-velocity prediction, and matches to the last frame where that fails. The baseline
/// that has nothing left where there is no texture: the pose is held, and every few frames looked
/// for among the keyframes.
class OrbTracker : public Tracker {
 public:
  OrbTracker(const OrbTrackerConfig& config, const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const history::Revision&,
                    const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return false; }

 private:
  features::VisualPose localise(const features::OrbFrame& current, double timestamp_s) const;
  std::optional<features::VisualPose> find_again(const features::OrbFrame& current) const;
  bool wants_keyframe(const features::OrbFrame& current, const SE3& T, int matches);
  void insert_keyframe(const features::OrbFrame& current, const SE3& T);

  OrbTrackerConfig config_;
  features::OrbExtractor extractor_;
  features::VisualMap map_;
  MotionModel motion_;                          // camera to world
  std::optional<features::OrbFrame> previous_;  // of the last tracked frame
  SE3 T_keyframe_;
  double keyframe_depth_m_ = 0;  // mean
  int keyframe_matches_ = 0;     // of the first frame after the keyframe; 0 = not seen yet
};

}  // namespace sgs::tracker
