// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/degeneracy/fusion.h"
#include "sgs/features/visual_pose.h"
#include "sgs/tracker/geometric_term.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// The tracker of Spectral GS-SLAM (Tan, Lam, Zhang, IROS 2026): registration whose Hessian decides
/// by its condition numbers which axes are degenerate, with a pose prior from ORB matches to the
/// last frame added to the cost on those axes, weighted by how planar the matched Gaussians are.
/// docs/method.md, sections 2 to 6, column "paper"; `fusion = prior`. What the paper leaves open:
///  - a rejected prior means no motion, with the identity as its information: nothing is measured,
///    so the shape is arbitrary, and its size comes from the registration's trace anyway;
///  - "lost" (a pose held, no keyframe) is not in the paper; the limits are GicpTracker's.
class PriorTracker : public Tracker {
 public:
  PriorTracker(const TrackerConfig& config, const PinholeCamera& camera, const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return geometry_.targets().follows_map(); }

 private:
  struct PosePrior {
    SE3 T_map_camera;
    Matrix6d information = Matrix6d::Zero();  // zero: there is no prior
  };
  PosePrior find_prior(const RgbdFrame& frame, Diagnostics& d);
  bool register_frame(const PosePrior& prior, SE3& T_map_camera, Diagnostics& d);
  degeneracy::AxisPrior choose_axes(const Matrix6d& H_icp, const PosePrior& prior, Diagnostics& d);
  double planarity() const;
  void accept(const SE3& T_map_camera, double timestamp_s);

  TrackerConfig config_;
  SE3 T_world_map_;
  GeometricTerm geometry_;
  MotionModel motion_;           // camera to map; starts at the previous pose
  MotionModel constant_motion_;  // the prior of `source = cvm`
  features::OrbExtractor extractor_;
  features::OrbFrame current_;
  std::optional<features::OrbFrame> previous_;  // of the last tracked frame
  int frames_ = 0;
  bool was_active_ = false;  // in the last frame
};

}  // namespace sgs::tracker
