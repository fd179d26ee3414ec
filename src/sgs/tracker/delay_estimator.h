// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/depth_calibration.h"
#include "sgs/geometry/se3.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Learns by how much later depth is measured than its stamp says, from where surfaces and picture
/// pull a pose: if depth is late by tau, surfaces see the camera where it is tau later, and so they
/// pull along its velocity. A camera's two images are stamped when they arrive, and that is not
/// when they were taken: a Kinect's depth has been seen 17 ms before its colour of the same stamp.
///
/// With the normal equations of both, (H_g, b_g) and (H_v, b_v), at a pose where they balance,
/// their optima are apart by c = -(H_g^-1 + H_v^-1) b_g, with information
/// L = H_g (H_g + H_v)^-1 H_v; so tau = v^T L c / v^T L v = -v^T b_g / v^T L v, v the camera's
/// twist per second. Sums over frames forget slowly; a prior keeps tau at 0 until there is motion.
class DelayEstimator {
 public:
  explicit DelayEstimator(const DelayConfig& config)
      : config_(config), prior_sigma_s_(config.prior_sigma_s) {}

  /// By how much later depth is measured than stamped, as believed now, seconds.
  double delay_s() const { return delay_s_; }
  /// Takes in an accepted frame: `H_geometry`, `H_vision`, `b_vision` as they entered its fusion,
  /// at its pose, and its camera twist per second. Its points were corrected for delay_s().
  void update(const Matrix6d& H_geometry, const Matrix6d& H_vision, const Vector6d& b_vision,
              const Vector6d& velocity);
  /// Stamps are read with `delay_s` more from now on, by a calibration that knows it to `sigma_s`.
  void shift(double delay_s, double sigma_s);

 private:
  void solve();

  DelayConfig config_;
  double information_ = 0, weighted_ = 0;  // 1/s^2, and times the delay that was measured
  double delay_s_ = 0;
  double prior_sigma_s_;
};

/// How sure a delay of 0 is at the start where depth comes with a calibration that tells it: frames
/// that follow each other hardly show a delay that all of them share, so what they seem to show
/// must not be added to what is known.
DelayConfig beside(DelayConfig config, const DepthCalibration& calibration);

}  // namespace sgs::tracker
