// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/degeneracy/observability.h"
#include "sgs/tracker/geometric_term.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// Registration of each frame's depth to the map: the GS-ICP SLAM baseline (Ha, Yeon, Yu, ECCV
/// 2024) with the `paper` preset's settings, projective point to plane with the `default` ones.
/// Geometry alone: where it does not see a direction the pose slides, which status and
/// diagnostics say (kDegenerate) but nothing here prevents.
class GicpTracker : public Tracker {
 public:
  GicpTracker(const TrackerConfig& config, const PinholeCamera& camera, const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return geometry_.targets().follows_map(); }

 private:
  bool register_frame(double timestamp_s, SE3& T_map_camera, Diagnostics& d);
  void describe_spectrum(const Matrix6d& H, Diagnostics& d);

  TrackerConfig config_;
  SE3 T_world_map_;
  GeometricTerm geometry_;
  MotionModel motion_;  // camera to map
  degeneracy::HysteresisState hysteresis_;
};

}  // namespace sgs::tracker
