// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "sgs/degeneracy/fusion.h"
#include "sgs/degeneracy/spectrum.h"
#include "sgs/features/visual_pose.h"
#include "sgs/tracker/registration_tracker.h"

namespace sgs::tracker {

/// The tracker of Spectral GS-SLAM (Tan, Lam, Zhang, IROS 2026): registration whose Hessian decides
/// by its condition numbers which axes are degenerate, with a pose prior from ORB matches to the
/// last frame added to the cost on those axes, weighted by how planar the matched Gaussians are.
/// docs/method.md, sections 2 to 6, column "paper". What the paper leaves open:
///  - a rejected prior means no motion, with the identity as its information: nothing is measured,
///    so the shape is arbitrary, and its size comes from the registration's trace anyway;
///  - "lost" (a pose held, no keyframe) is not in the paper; the limits are GicpTracker's.
class PaperTracker : public RegistrationTracker {
 public:
  PaperTracker(const PaperConfig& config, const PinholeCamera& camera, const SE3& T_world_first);

 private:
  struct PosePrior {
    PriorSource source = PriorSource::kNone;
    SE3 T_local_camera;
    Matrix6d information = Matrix6d::Zero();
    int inliers = 0;  // features
  };
  // Where the prior acts, and how strongly.
  struct ChosenAxes {
    degeneracy::AxisPrior prior;
    degeneracy::Spectrum spectrum;
    double planarity = 0;
    std::array<double, 6> weights = {0, 0, 0, 0, 0, 0};
    bool active = false;
  };

  void look_at(const RgbdFrame& frame) override;
  Registration register_frame(double timestamp_s) override;
  void describe_axes(bool registered, Diagnostics& d) const override;
  void accept(const SE3& T_local_camera, double timestamp_s) override;
  void hold() override;

  PosePrior find_prior(const RgbdFrame& frame);
  PosePrior orb_prior() const;
  registration::PoseSolution minimise(const SE3& T_start);
  ChosenAxes choose_axes(const Matrix6d& H_icp) const;
  double planarity() const;

  PriorConfig prior_config_;
  features::VisualPoseConfig visual_pose_;
  MotionModel constant_motion_;  // the prior of `source = cvm`
  features::OrbExtractor extractor_;
  features::OrbFrame current_;
  std::optional<features::OrbFrame> previous_;  // of the last tracked frame
  int frames_ = 0;
  bool was_active_ = false;  // in the last frame

  // Of the current frame:
  PosePrior prior_;
  std::optional<ChosenAxes> axes_;  // frozen at the first linearisation
};

}  // namespace sgs::tracker
