// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/geometry/se3.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

namespace sgs {
namespace {

// sin(x)/x, (1-cos x)/x^2 and (x-sin x)/x^3 with Taylor series where the quotients cancel.
struct Coefficients {
  double a, b, c;
};
Coefficients coefficients(double theta) {
  const double x2 = theta * theta;
  if (theta < 1e-3) {
    return {1 - x2 / 6 * (1 - x2 / 20), 0.5 - x2 / 24 * (1 - x2 / 30),
            1.0 / 6 - x2 / 120 * (1 - x2 / 42)};
  }
  const double half = std::sin(0.5 * theta);
  return {std::sin(theta) / theta, 2 * half * half / x2, (theta - std::sin(theta)) / (x2 * theta)};
}

// Inverse of the left Jacobian of SO(3), which also is V^-1 of the SE(3) logarithm.
Eigen::Matrix3d left_jacobian_inverse(const Eigen::Vector3d& phi) {
  const double theta = phi.norm();
  const Eigen::Matrix3d W = hat(phi);
  double k = 1.0 / 12 + theta * theta / 720;
  if (theta > 1e-3) {
    const double half = 0.5 * theta;
    k = (1 - half * std::cos(half) / std::sin(half)) / (theta * theta);
  }
  return Eigen::Matrix3d::Identity() - 0.5 * W + k * W * W;
}

// Coupling block Q of the left Jacobian (Barfoot eq. 7.86), rotation vector phi, translation rho.
Eigen::Matrix3d coupling_block(const Eigen::Vector3d& phi, const Eigen::Vector3d& rho) {
  const double th = phi.norm(), th2 = th * th;
  const Eigen::Matrix3d P = hat(phi), Q = hat(rho);
  double c1 = 1.0 / 6, c2 = 1.0 / 24, c3 = 1.0 / 120;
  if (th > 1e-2) {
    c1 = (th - std::sin(th)) / (th2 * th);
    c2 = (th2 + 2 * std::cos(th) - 2) / (2 * th2 * th2);
    c3 = (2 * th - 3 * std::sin(th) + th * std::cos(th)) / (2 * th2 * th2 * th);
  } else {
    c1 -= th2 / 120;
    c2 -= th2 / 720;
    c3 -= th2 / 2520;
  }
  return 0.5 * Q + c1 * (P * Q + Q * P + P * Q * P) + c2 * (P * P * Q + Q * P * P - 3 * P * Q * P) +
         c3 * (P * Q * P * P + P * P * Q * P);
}

Matrix6d left_jacobian(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.head<3>();
  Matrix6d J = Matrix6d::Zero();
  const Eigen::Matrix3d Jl = so3_right_jacobian(-phi);
  J.topLeftCorner<3, 3>() = Jl;
  J.bottomRightCorner<3, 3>() = Jl;
  J.bottomLeftCorner<3, 3>() = coupling_block(phi, xi.tail<3>());
  return J;
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi) {
  const auto [a, b, c] = coefficients(phi.norm());
  const Eigen::Matrix3d W = hat(phi);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& R) {
  // The quaternion is well conditioned over the whole range; near pi its vector part is the axis.
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double n = q.vec().norm();
  const double scale = n < 1e-9 ? 2.0 / q.w() : 2.0 * std::atan2(n, q.w()) / n;
  return scale * q.vec();
}

Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& phi) {
  const auto [a, b, c] = coefficients(phi.norm());
  const Eigen::Matrix3d W = hat(phi);
  return Eigen::Matrix3d::Identity() - b * W + c * W * W;
}

Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& phi) {
  return left_jacobian_inverse(-phi);
}

SE3 SE3::exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.head<3>();
  const auto [a, b, c] = coefficients(phi.norm());
  const Eigen::Matrix3d W = hat(phi), W2 = W * W;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  return {I + a * W + b * W2, (I + b * W + c * W2) * xi.tail<3>()};
}

Vector6d SE3::log() const {
  Vector6d xi;
  const Eigen::Vector3d phi = so3_log(R);
  xi << phi, left_jacobian_inverse(phi) * t;
  return xi;
}

Matrix6d SE3::adjoint() const {
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = R;
  A.bottomRightCorner<3, 3>() = R;
  A.bottomLeftCorner<3, 3>() = hat(t) * R;
  return A;
}

SE3 SE3::normalized() const { return {quaternion().toRotationMatrix(), t}; }

Matrix6d se3_right_jacobian(const Vector6d& xi) { return left_jacobian(-xi); }

Matrix6d se3_right_jacobian_inverse(const Vector6d& xi) {
  const Matrix6d J = left_jacobian(-xi);
  const Eigen::Matrix3d A = left_jacobian_inverse(-xi.head<3>());
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = A;
  out.bottomRightCorner<3, 3>() = A;
  out.bottomLeftCorner<3, 3>() = -A * J.bottomLeftCorner<3, 3>() * A;
  return out;
}

SE3 interpolate(const SE3& a, const SE3& b, double alpha) {
  return {a.quaternion().slerp(alpha, b.quaternion()), (1 - alpha) * a.t + alpha * b.t};
}

}  // namespace sgs
