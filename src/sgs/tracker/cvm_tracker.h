// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// Constant velocity without looking at the images: every frame repeats the first motion, which is
/// none. The trivial yardstick of the ablations; never lost, never right for long.
class CvmTracker : public Tracker {
 public:
  CvmTracker(const TrackerConfig& config, const SE3& T_world_first)
      : motion_(config.motion, T_world_first) {}

  TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr&) override {
    TrackResult result;
    result.T_world_camera = motion_.predict(frame.timestamp_s);
    result.diagnostics.prior_source = "cvm";
    result.diagnostics.prior_active = true;
    result.keyframe = first_;
    first_ = false;
    motion_.accept(result.T_world_camera, frame.timestamp_s);
    return result;
  }
  bool follows_map() const override { return false; }

 private:
  MotionModel motion_;
  bool first_ = true;
};

}  // namespace sgs::tracker
