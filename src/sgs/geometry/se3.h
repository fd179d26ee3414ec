// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sgs {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Skew-symmetric matrix with hat(a) * b == a.cross(b).
Eigen::Matrix3d hat(const Eigen::Vector3d& v);

/// Rotation matrix of a rotation vector (Rodrigues); accurate for all lengths.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi);
/// Rotation vector of a rotation matrix, length in [0, pi]; accurate near 0 and near pi.
Eigen::Vector3d so3_log(const Eigen::Matrix3d& R);
/// Right Jacobian: so3_exp(phi + d) ~ so3_exp(phi) * so3_exp(Jr(phi) * d).
Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& phi);
Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& phi);

/// Rigid transform. `T_a_b` maps coordinates in b to coordinates in a. Twists are rotation first,
/// xi = [phi; rho], and perturb on the right: T * SE3::exp(xi).
struct SE3 {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  SE3() = default;
  SE3(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : R(rotation), t(translation) {}
  SE3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : R(rotation.normalized().toRotationMatrix()), t(translation) {}

  static SE3 exp(const Vector6d& xi);
  Vector6d log() const;

  SE3 operator*(const SE3& other) const { return {R * other.R, R * other.t + t}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
  SE3 inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
  /// 6x6 adjoint for rotation-first twists: T * exp(xi) == exp(adjoint() * xi) * T.
  Matrix6d adjoint() const;
  /// The same transform with R projected back onto SO(3); removes rounding after long products.
  SE3 normalized() const;
  Eigen::Quaterniond quaternion() const { return Eigen::Quaterniond(R).normalized(); }
  bool all_finite() const { return R.allFinite() && t.allFinite(); }
  /// Rotation angle in radians, [0, pi].
  double angle() const { return so3_log(R).norm(); }
};

/// Right Jacobian of SE(3): exp(xi + d) ~ exp(xi) * exp(Jr(xi) * d); and its inverse, with
/// log(T * exp(d)) ~ log(T) + Jr^-1(log T) * d. (Barfoot, State Estimation for Robotics, ch. 7.)
Matrix6d se3_right_jacobian(const Vector6d& xi);
Matrix6d se3_right_jacobian_inverse(const Vector6d& xi);

/// Straight line in translation, slerp in rotation; `alpha` 0 gives a, 1 gives b.
SE3 interpolate(const SE3& a, const SE3& b, double alpha);

}  // namespace sgs
