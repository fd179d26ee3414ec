// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "sgs/core/enum_names.h"

namespace sgs {

/// How a lens pictures directions.
enum class LensModel {
  kBrown,    ///< by the tangent of the angle off the axis, bent by a few per cent
  kFisheye,  ///< by the angle itself
};

constexpr auto enum_names(LensModel) {
  using enum LensModel;
  return std::to_array<EnumName<LensModel>>({{kBrown, "brown"}, {kFisheye, "fisheye"}});
}

/// Distortion of a lens, of one of two models.
///
/// kBrown is radial-tangential (Brown-Conrady) in OpenCV's order k1 k2 p1 p2 k3, with the
/// denominator k4 k5 k6 of OpenCV's rational model where a lens needs it:
///   x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + tangential terms.
///
/// kFisheye has k1 k2 k3 k4 and nothing else (Kannala and Brandt 2006, equation 6, as OpenCV's
/// cv::fisheye and ROS's `equidistant` write it): at the angle theta off the axis,
///   r_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8).
/// With four zeros it is still a fisheye.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  double k4 = 0, k5 = 0, k6 = 0;
  LensModel model = LensModel::kBrown;

  /// From 0, 4, 5 or 8 coefficients in OpenCV's order, of a fisheye from 4 (0 are four zeros);
  /// empty for other numbers of them.
  static std::optional<Distortion> from_coefficients(std::span<const double> values,
                                                     LensModel model = LensModel::kBrown);
  /// k1 k2 p1 p2 k3, and k4 k5 k6 where the lens needs them; of a fisheye k1 k2 k3 k4.
  std::vector<double> written() const;
  /// k1 k2 p1 p2 k3 k4 k5 k6.
  std::array<double, 8> coefficients() const { return {k1, k2, p1, p2, k3, k4, k5, k6}; }
  bool is_zero() const { return *this == Distortion{}; }
  bool is_fisheye() const { return model == LensModel::kFisheye; }
  bool is_rational() const { return !is_fisheye() && (k4 != 0 || k5 != 0 || k6 != 0); }

  /// Distorted normalised image coordinates of undistorted ones.
  Eigen::Vector2d apply(const Eigen::Vector2d& xy) const {
    if (is_fisheye()) return apply_fisheye(xy);
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

 private:
  /// Distance from the centre at which a fisheye pictures the angle `theta`.
  double pictured_angle(double theta) const {
    const double t2 = theta * theta;
    return theta * (1 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))));
  }
  Eigen::Vector2d apply_fisheye(const Eigen::Vector2d& xy) const {
    const double r = xy.norm();
    return r > 0 ? Eigen::Vector2d(pictured_angle(std::atan(r)) / r * xy) : xy;
  }
  std::optional<Eigen::Vector2d> invert_fisheye(const Eigen::Vector2d& distorted) const;
};

}  // namespace sgs
