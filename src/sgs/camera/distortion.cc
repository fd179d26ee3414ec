// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/distortion.h"

#include <Eigen/LU>
#include <limits>

namespace sgs {
namespace {

/// Derivative of Distortion::apply().
Eigen::Matrix2d distortion_jacobian(const Distortion& d, const Eigen::Vector2d& xy) {
  const double x = xy.x(), y = xy.y(), r2 = x * x + y * y;
  const double above = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  const double below = 1 + r2 * (d.k4 + r2 * (d.k5 + r2 * d.k6));
  const double radial = above / below;
  const double above_slope = d.k1 + r2 * (2 * d.k2 + r2 * 3 * d.k3);
  const double below_slope = d.k4 + r2 * (2 * d.k5 + r2 * 3 * d.k6);
  const double slope = 2 * (above_slope - radial * below_slope) / below;  // d radial / d r2, twice
  const double cross = x * y * slope + 2 * (d.p1 * x + d.p2 * y);
  Eigen::Matrix2d J;
  J << radial + x * x * slope + 2 * d.p1 * y + 6 * d.p2 * x, cross,  //
      cross, radial + y * y * slope + 6 * d.p1 * y + 2 * d.p2 * x;
  return J;
}

}  // namespace

std::optional<Distortion> Distortion::from_coefficients(std::span<const double> values) {
  const std::size_t n = values.size();
  if (n != 0 && n != 4 && n != 5 && n != 8) return std::nullopt;
  const auto at = [&](std::size_t i) { return i < n ? values[i] : 0.0; };
  return Distortion{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
}

std::vector<double> Distortion::written() const {
  const auto all = coefficients();
  return {all.begin(), is_rational() ? all.end() : all.begin() + 5};
}

double Distortion::fold_radius() const {
  constexpr double kFarthest = 5.67;  // tan of 80 degrees
  constexpr double kStep = 1e-3;
  double before = 0;
  for (double r = kStep; r <= kFarthest; r += kStep) {
    const double r2 = r * r;
    const double below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
    const double pictured = r * (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / below;
    if (!(below > 0 && pictured > before)) return r - kStep;
    before = pictured;
  }
  return std::numeric_limits<double>::infinity();
}

std::optional<Eigen::Vector2d> Distortion::invert(const Eigen::Vector2d& distorted) const {
  constexpr int kMaxSteps = 50;
  constexpr double kTolerance = 1e-12;  // of coordinates of the order 1
  Eigen::Vector2d xy = distorted;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector2d miss = apply(xy) - distorted;
    const Eigen::Matrix2d J = distortion_jacobian(*this, xy);
    // Negative beyond the radius where the model turns back towards the centre.
    if (!(J.determinant() > 0 && J.trace() > 0)) return std::nullopt;
    if (miss.norm() < kTolerance) return xy;
    xy -= J.inverse() * miss;
  }
  return std::nullopt;
}

}  // namespace sgs
