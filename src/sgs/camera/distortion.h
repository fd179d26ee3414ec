// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

namespace sgs {

/// Radial-tangential (Brown-Conrady) distortion in OpenCV's order k1 k2 p1 p2 k3, with the
/// denominator k4 k5 k6 of OpenCV's rational model where a lens needs it:
///   x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + tangential terms.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double k4 = 0, k5 = 0, k6 = 0;

  /// From 0, 4, 5 or 8 coefficients in OpenCV's order; empty for other numbers of them.
  static std::optional<Distortion> from_coefficients(std::span<const double> values);
  /// k1 k2 p1 p2 k3, and k4 k5 k6 where the lens needs them.
  std::vector<double> written() const;
  /// k1 k2 p1 p2 k3 k4 k5 k6.
  std::array<double, 8> coefficients() const { return {k1, k2, p1, p2, k3, k4, k5, k6}; }
  bool is_zero() const { return *this == Distortion{}; }
  bool is_rational() const { return k4 != 0 || k5 != 0 || k6 != 0; }

  /// Distorted normalised image coordinates of undistorted ones.
  Eigen::Vector2d apply(const Eigen::Vector2d& xy) const {
    const double x = xy.x(), y = xy.y(), r2 = x * x + y * y;
    const double radial =
        (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  }
  /// Distance from the axis, undistorted and normalised, up to which what is farther out is also
  /// pictured farther out; infinite where that is so as far as any pinhole camera sees (80 degrees
  /// off its axis).
  double fold_radius() const;
  /// Undistorted normalised image coordinates of distorted ones (Newton's method on apply()). Empty
  /// where the model cannot be turned round: beyond the radius at which it folds back.
  std::optional<Eigen::Vector2d> invert(const Eigen::Vector2d& distorted) const;

  friend bool operator==(const Distortion&, const Distortion&) = default;
};

}  // namespace sgs
