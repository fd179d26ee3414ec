// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/step_times.h"
#include "sgs/alignment/terms/geometric_term.h"
#include "sgs/registration/pose_solver.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// What trackers share that register each frame's depth to the target map: the frame is sampled,
/// registered by the tracker at hand, checked, and becomes a keyframe where the map explains too
/// little of it. A lost frame holds the last pose.
class RegistrationTracker : public Tracker {
 public:
  TrackResult track(const RgbdFrame& frame, const history::Revision& revision,
                    const map::SnapshotPtr& snapshot) final;
  bool knows_depth_lag() const final { return true; }
  bool follows_map() const final { return geometry_.targets().follows_map(); }

 protected:
  RegistrationTracker(const GicpConfig& config, const PinholeCamera& camera,
                      const SE3& T_world_first);

  /// A frame's pose and what it rests on.
  struct Registration {
    SE3 T_local_camera;
    registration::Linearization at_end;  ///< of the registration alone
    double cost = 0;
    double overlap = 0;
    int iterations = 0;
    bool degenerate = false;  ///< registration alone left an axis open
  };

  /// Looks at what the frame holds beside depth; comes before register_frame().
  virtual void look_at(const RgbdFrame&) {}
  /// Registers the frame last sampled, to targets that there are.
  virtual Registration register_frame(double timestamp_s) = 0;
  /// Adds what this tracker knows about the frame's axes and prior; `registered` is off where
  /// register_frame() was not called.
  virtual void describe_axes(bool registered, Diagnostics& d) const = 0;
  /// The frame's pose can be trusted, or not.
  virtual void accept(const SE3& T_local_camera, double timestamp_s);
  virtual void hold();

  GicpConfig config_;
  alignment::GeometricTerm geometry_;
  MotionModel motion_;          // camera to local
  alignment::StepTimes times_;  // of the current frame

 private:
  alignment::LostReason judge(const Registration& r) const;
  Diagnostics describe(const Registration* r) const;

  SE3 T_world_local_;
  alignment::LocalPast past_;
};

}  // namespace sgs::tracker
