// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/tracker/tracker.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Takes the pose that came with the frame (RgbdFrame::given_T_world_camera) as it is: of another
/// SLAM, a phone, motion capture, structure from motion. The world is that of the poses. Frames may
/// be far apart and come in any order; one without a pose, or whose pose is not finite, is lost.
class GivenTracker : public Tracker {
 public:
  explicit GivenTracker(const GivenConfig& config) : config_(config) {}

  TrackResult track(const RgbdFrame& frame, const history::Revision&,
                    const map::SnapshotPtr&) override;
  bool follows_map() const override { return false; }
  bool needs_video() const override { return false; }
  bool moves_keyframes() const override { return config_.refine; }
  bool path_follows_refinement() const override { return config_.refine; }

 private:
  bool is_new_view(const RgbdFrame& frame, const SE3& T_world_camera) const;

  GivenConfig config_;
  SE3 T_world_last_;                     // of the last frame with a pose
  std::optional<SE3> T_world_keyframe_;  // of the last keyframe
};

}  // namespace sgs::tracker
