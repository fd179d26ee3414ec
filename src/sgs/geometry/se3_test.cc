// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/geometry/se3.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

namespace sgs {
namespace {

constexpr double kPi = std::numbers::pi;

class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Eigen::Vector3d direction() {
    Eigen::Vector3d v;
    do {
      v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    } while (v.norm() < 0.1);
    return v.normalized();
  }
  Vector6d twist(double angle) {
    Vector6d xi;
    xi << angle * direction(), uniform(-3, 3) * direction();
    return xi;
  }

 private:
  std::mt19937_64 engine_{11};
};

// Where the closed forms lose digits: around 0, the switches to the series, and pi.
const double kAngles[] = {0,      1e-12, 1e-9, 1e-6, 9e-4,       1.1e-3,     9e-3,
                          1.1e-2, 0.3,   1.0,  2.0,  kPi - 1e-3, kPi - 1e-6, kPi - 1e-9};

TEST(So3, ExpIsARotationAndLogInverts) {
  Random random;
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d phi = angle * random.direction();
      const Eigen::Matrix3d R = so3_exp(phi);
      EXPECT_TRUE((R * R.transpose()).isIdentity(1e-14)) << angle;
      EXPECT_NEAR(R.determinant(), 1, 1e-14);
      EXPECT_LT((so3_log(R) - phi).norm(), 1e-13 + 1e-12 * angle) << angle;
    }
  }
}

TEST(So3, LogAtPiGivesTheAxisUpToSign) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d axis = random.direction();
    const Eigen::Vector3d phi = so3_log(so3_exp(kPi * axis));
    EXPECT_NEAR(phi.norm(), kPi, 1e-12);
    EXPECT_NEAR(std::abs(phi.dot(axis)), kPi, 1e-12);
  }
}

TEST(Se3, LogInvertsExp) {
  Random random;
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vector6d xi = random.twist(angle);
      EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-11) << angle;
    }
  }
}

TEST(Se3, GroupLawsAndAdjoint) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const SE3 A = SE3::exp(random.twist(1.2)), B = SE3::exp(random.twist(2.5));
    const Vector6d xi = random.twist(0.7);
    const Eigen::Vector3d p = random.direction();
    EXPECT_LT(((A * B) * p - A * (B * p)).norm(), 1e-13);
    EXPECT_LT((A * A.inverse()).log().norm(), 1e-13);
    const SE3 left = A * SE3::exp(xi), right = SE3::exp(A.adjoint() * xi) * A;
    EXPECT_LT((left.R - right.R).norm() + (left.t - right.t).norm(), 1e-12);
  }
}

// Right Jacobians against central differences of the group operations that define them.
TEST(Jacobians, MatchCentralDifferences) {
  Random random;
  constexpr double kStep = 1e-6, kTolerance = 2e-8;
  for (const double angle : {1e-12, 5e-4, 9.9e-3, 1.01e-2, 0.5, 1.5, 2.8}) {
    const Vector6d xi = random.twist(angle);
    const SE3 T = SE3::exp(xi);
    Matrix6d forward, inverse;
    Eigen::Matrix3d so3_forward, so3_inverse;
    const Eigen::Vector3d phi = xi.head<3>();
    for (int k = 0; k < 6; ++k) {
      const Vector6d d = kStep * Vector6d::Unit(k);
      forward.col(k) =
          ((T.inverse() * SE3::exp(xi + d)).log() - (T.inverse() * SE3::exp(xi - d)).log()) /
          (2 * kStep);
      inverse.col(k) = ((T * SE3::exp(d)).log() - (T * SE3::exp(-d)).log()) / (2 * kStep);
    }
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(k);
      so3_forward.col(k) = (so3_log(T.R.transpose() * so3_exp(phi + d)) -
                            so3_log(T.R.transpose() * so3_exp(phi - d))) /
                           (2 * kStep);
      so3_inverse.col(k) = (so3_log(T.R * so3_exp(d)) - so3_log(T.R * so3_exp(-d))) / (2 * kStep);
    }
    EXPECT_LT((se3_right_jacobian(xi) - forward).cwiseAbs().maxCoeff(), kTolerance) << angle;
    EXPECT_LT((se3_right_jacobian_inverse(xi) - inverse).cwiseAbs().maxCoeff(), kTolerance)
        << angle;
    EXPECT_LT((so3_right_jacobian(phi) - so3_forward).cwiseAbs().maxCoeff(), kTolerance) << angle;
    EXPECT_LT((so3_right_jacobian_inverse(phi) - so3_inverse).cwiseAbs().maxCoeff(), kTolerance)
        << angle;
    EXPECT_TRUE((se3_right_jacobian(xi) * se3_right_jacobian_inverse(xi)).isIdentity(1e-9));
  }
}

TEST(Se3, InterpolationAndNormalisation) {
  const SE3 a, b(so3_exp({0, 0, 1.0}), {2, 0, 0});
  EXPECT_LT((interpolate(a, b, 0).inverse() * a).log().norm(), 1e-14);
  EXPECT_LT((interpolate(a, b, 1).inverse() * b).log().norm(), 1e-14);
  const SE3 middle = interpolate(a, b, 0.25);
  EXPECT_NEAR(middle.angle(), 0.25, 1e-13);
  EXPECT_NEAR(middle.t.x(), 0.5, 1e-15);
  SE3 drifted = b;
  drifted.R *= 1 + 1e-9;  // the rounding of many products
  EXPECT_TRUE((drifted.normalized().R * drifted.normalized().R.transpose()).isIdentity(1e-14));
  EXPECT_TRUE(drifted.normalized().R.isApprox(b.R, 1e-9));
}

}  // namespace
}  // namespace sgs
