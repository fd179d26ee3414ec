// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/agreement.h"

#include <Eigen/LU>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs::backend {
namespace {

double in_deviations(double difference, double sigma_a, double sigma_b) {
  const double sigma = std::hypot(sigma_a, sigma_b);
  return sigma > 0 ? std::abs(difference) / sigma : 0;
}

}  // namespace

std::string CalibrationParts::names() const {
  std::string out;
  const auto add = [&](bool has, const char* name) {
    if (has) out += (out.empty() ? "" : ", ") + std::string(name);
  };
  add(mean, "mean offset");
  add(shape, "shape");
  add(shift, "shift");
  add(delay, "delay");
  return out;
}

CalibrationParts operator|(const CalibrationParts& a, const CalibrationParts& b) {
  return {a.mean || b.mean, a.shape || b.shape, a.shift || b.shift, a.delay || b.delay};
}

CalibrationParts operator&(const CalibrationParts& a, const CalibrationParts& b) {
  return {a.mean && b.mean, a.shape && b.shape, a.shift && b.shift, a.delay && b.delay};
}

CalibrationParts without(const CalibrationParts& a, const CalibrationParts& b) {
  return {a.mean && !b.mean, a.shape && !b.shape, a.shift && !b.shift, a.delay && !b.delay};
}

Disagreement compare(const FreeEstimate& a, const FreeEstimate& b) {
  SGS_CHECK(a.shape_per_m.size() == b.shape_per_m.size(), "estimates over two grids");
  Disagreement d;
  const double mean = a.mean_per_m - b.mean_per_m, delay = a.delay_s - b.delay_s;
  d.mean = {in_deviations(mean, a.mean_sigma_per_m, b.mean_sigma_per_m), std::abs(mean) / 2,
            std::abs(a.mean_per_m + b.mean_per_m) / 2};
  d.delay = {in_deviations(delay, a.delay_sigma_s, b.delay_sigma_s), std::abs(delay) / 2,
             std::abs(a.delay_s + b.delay_s) / 2};
  const Eigen::Vector2d shift = a.shift_px - b.shift_px;
  const Eigen::Matrix2d covariance = a.shift_covariance + b.shift_covariance;
  d.half_shift_px = shift.cwiseAbs() / 2;
  d.shift.half = shift.norm() / 2;
  d.shift.size = (a.shift_px + b.shift_px).norm() / 2;
  if (covariance.determinant() > 0) {
    d.shift.sigmas = std::sqrt(shift.dot(covariance.inverse() * shift));
  }
  double chi2 = 0, square = 0, sum = 0;
  for (std::size_t k = 0; k < a.shape_per_m.size(); ++k) {
    const double off = a.shape_per_m[k] - b.shape_per_m[k];
    const double sigmas = in_deviations(off, a.shape_sigma_per_m[k], b.shape_sigma_per_m[k]);
    chi2 += a.area[k] * sigmas * sigmas;
    square += a.area[k] * off * off;
    sum += a.area[k] * std::pow(a.shape_per_m[k] + b.shape_per_m[k], 2);
    d.half_shape_per_m.push_back(std::abs(off) / 2);
  }
  d.shape = {std::sqrt(chi2), std::sqrt(square) / 2, std::sqrt(sum) / 2};
  return d;
}

CalibrationParts contradicted(const Disagreement& d) {
  constexpr double kDeviations = 3, kShapeChi2 = 3;
  constexpr double kOfSize = 0.2;
  constexpr double kNothing_per_m = 1e-4, kNothing_px = 0.1, kNothing_s = 5e-4;
  const auto differ = [](const Disagreement::Of& part, double deviations, double nothing) {
    return part.sigmas > deviations && 2 * part.half > nothing && part.half > kOfSize * part.size;
  };
  return {differ(d.mean, kDeviations, kNothing_per_m),
          differ(d.shape, std::sqrt(kShapeChi2), kNothing_per_m),
          differ(d.shift, kDeviations, kNothing_px), differ(d.delay, kDeviations, kNothing_s)};
}

Fit operator+(const Fit& a, const Fit& b) {
  Fit out;
  out.grey_residuals = a.grey_residuals + b.grey_residuals;
  out.depth_residuals = a.depth_residuals + b.depth_residuals;
  if (out.grey_residuals > 0) {
    out.grey = (a.grey * a.grey_residuals + b.grey * b.grey_residuals) / out.grey_residuals;
  }
  if (out.depth_residuals > 0) {
    out.depth = (a.depth * a.depth_residuals + b.depth * b.depth_residuals) / out.depth_residuals;
  }
  return out;
}

bool fits_better(const Fit& with, const Fit& without) {
  constexpr double kWorse = 1.02, kFound = 0.95;
  if (!(without.grey > 0 && without.depth > 0)) return false;
  const double grey = with.grey / without.grey, depth = with.depth / without.depth;
  return grey + depth < 2 && grey <= kWorse && depth <= kWorse &&
         with.grey_residuals >= kFound * without.grey_residuals &&
         with.depth_residuals >= kFound * without.depth_residuals;
}

}  // namespace sgs::backend
