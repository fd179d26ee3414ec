// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// Constant velocity without looking at the images: every frame repeats the first motion, which is
/// none. The trivial yardstick of the ablations; never right for long, and lost only where a
/// timestamp is not a number.
class CvmTracker : public Tracker {
 public:
  CvmTracker(const MotionConfig& config, const SE3& T_world_first)
      : motion_(config, T_world_first) {}

  TrackResult track(const RgbdFrame& frame, const history::Revision&,
                    const map::SnapshotPtr&) override {
    TrackResult result;
    result.diagnostics.prior_source = PriorSource::kConstantVelocity;
    result.diagnostics.prior_active = true;
    const SE3 T = motion_.predict(frame.timestamp_s);
    result.lost_reason = motion_.judge(T);
    if (result.lost_reason != alignment::LostReason::kNone) {
      motion_.hold();
      result.status = TrackingStatus::kLost;
    } else {
      motion_.accept(T, frame.timestamp_s);
      result.keyframe = first_;
      first_ = false;
    }
    result.T_odom_camera = motion_.pose();
    return result;
  }
  bool follows_map() const override { return false; }

 private:
  MotionModel motion_;
  bool first_ = true;
};

}  // namespace sgs::tracker
