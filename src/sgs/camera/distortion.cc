// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/distortion.h"

#include <Eigen/LU>
#include <limits>

namespace sgs {
namespace {

constexpr double kWidestTangent = 5.67;  // tan of 80 degrees
constexpr int kMaxSteps = 50;
constexpr double kTolerance = 1e-12;  // of coordinates of the order 1

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

std::optional<Distortion> Distortion::from_coefficients(std::span<const double> values,
                                                        LensModel model) {
  const std::size_t n = values.size();
  const auto at = [&](std::size_t i) { return i < n ? values[i] : 0.0; };
  if (model == LensModel::kFisheye) {
    if (n != 0 && n != 4) return std::nullopt;
    Distortion lens{at(0), at(1), 0, 0, at(2), at(3)};
    lens.model = model;
    return lens;
  }
  if (n != 0 && n != 4 && n != 5 && n != 8) return std::nullopt;
  return Distortion{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)};
}

std::vector<double> Distortion::written() const {
  if (is_fisheye()) return {k1, k2, k3, k4};
  const auto all = coefficients();
  return {all.begin(), is_rational() ? all.end() : all.begin() + 5};
}

double Distortion::fold_radius() const {
  constexpr double kStep = 1e-3;
  const auto pictured_at = [&](double r) {
    if (is_fisheye()) return pictured_angle(std::atan(r));
    const double r2 = r * r;
    const double below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
    return below > 0 ? r * (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / below : 0;
  };
  double before = 0;
  for (double r = kStep; r <= kWidestTangent; r += kStep) {
    const double pictured = pictured_at(r);
    if (!(pictured > before)) return r - kStep;
    before = pictured;
  }
  return std::numeric_limits<double>::infinity();
}

// Newton's method on the angle, which is nearly what is pictured. Directions that no pinhole camera
// sees have no coordinates.
std::optional<Eigen::Vector2d> Distortion::invert_fisheye(const Eigen::Vector2d& distorted) const {
  const double pictured = distorted.norm();
  if (pictured == 0) return distorted;
  double theta = pictured;
  for (int step = 0; step < kMaxSteps; ++step) {
    const double t2 = theta * theta;
    const double slope = 1 + t2 * (3 * k1 + t2 * (5 * k2 + t2 * (7 * k3 + t2 * 9 * k4)));
    if (!(slope > 0)) return std::nullopt;
    const double miss = pictured_angle(theta) - pictured;
    if (std::abs(miss) < kTolerance) {
      const double r = std::tan(theta);
      if (!(theta > 0 && theta < M_PI_2 && r <= kWidestTangent)) return std::nullopt;
      return Eigen::Vector2d(r / pictured * distorted);
    }
    theta -= miss / slope;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> Distortion::invert(const Eigen::Vector2d& distorted) const {
  if (is_fisheye()) return invert_fisheye(distorted);
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
