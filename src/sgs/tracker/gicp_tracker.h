// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/degeneracy/observability.h"
#include "sgs/degeneracy/spectrum.h"
#include "sgs/tracker/registration_tracker.h"

namespace sgs::tracker {

/// Registration of each frame's depth to the map: the GS-ICP SLAM baseline (Ha, Yeon, Yu, ECCV
/// 2024) with the `paper` preset's settings, projective point to plane with the `default` ones.
/// Geometry alone: where it does not see a direction the pose slides, which status and
/// diagnostics say (kDegenerate) but nothing here prevents.
class GicpTracker : public RegistrationTracker {
 public:
  GicpTracker(const GicpConfig& config, const PinholeCamera& camera, const SE3& T_world_first)
      : RegistrationTracker(config, camera, T_world_first) {}

 private:
  Registration register_frame(double timestamp_s) override;
  void describe_axes(bool registered, Diagnostics& d) const override;
  void find_unseen_axes(const Matrix6d& H);

  degeneracy::HysteresisState hysteresis_;
  // Of the last registration. The default detector needs the noise of the normals, which only the
  // plane fit gives; with the paper's sampling the condition number decides.
  degeneracy::Spectrum spectrum_;
  degeneracy::Observability observability_;
  bool by_condition_ = config_.geometry.points.method != registration::SamplingMethod::kPlaneFit;
  unsigned mask_ = 0;
};

}  // namespace sgs::tracker
