// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/delay_estimator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sgs::tracker {
namespace {

/// 0 where nobody says how sure.
double prior_sigma_beside(double own_s, double known_s) {
  constexpr double kSurest_s = 5e-4;
  return known_s > 0 ? std::min(own_s, std::max(known_s, kSurest_s)) : own_s;
}

}  // namespace

void DelayEstimator::update(const Matrix6d& H_geometry, const Matrix6d& H_vision,
                            const Vector6d& b_vision, const Vector6d& velocity) {
  if (!config_.estimate || velocity.isZero(0)) return;
  const Matrix6d L = H_geometry * (H_geometry + H_vision).ldlt().solve(H_vision);
  const double information = config_.information_scale * velocity.dot(L * velocity);
  if (!std::isfinite(information) || !(information > 0)) return;
  // At the balance of both, b_geometry = -b_vision. Where they are far apart the camera is at a
  // wrong place, or old surfaces have drifted: that is no delay.
  constexpr double kFarthest_s = 0.02;
  const double seen = config_.information_scale * velocity.dot(b_vision) / information;
  if (!std::isfinite(seen)) return;
  const double measured = delay_s_ + std::clamp(seen, -kFarthest_s, kFarthest_s);
  information_ = (1 - config_.forget) * information_ + information;
  weighted_ = (1 - config_.forget) * weighted_ + information * measured;
  solve();
}

void DelayEstimator::shift(double delay_s, double sigma_s) {
  weighted_ -= information_ * delay_s;
  prior_sigma_s_ = prior_sigma_beside(config_.prior_sigma_s, sigma_s);
  solve();
}

void DelayEstimator::solve() {
  const double prior = 1 / (prior_sigma_s_ * prior_sigma_s_);
  delay_s_ = std::clamp(weighted_ / (information_ + prior), -config_.most_s, config_.most_s);
}

DelayConfig beside(DelayConfig config, const DepthCalibration& calibration) {
  config.prior_sigma_s = prior_sigma_beside(config.prior_sigma_s, calibration.delay_sigma_s);
  return config;
}

}  // namespace sgs::tracker
