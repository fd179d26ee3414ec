// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sgs/registration/gicp_factor.h"
#include "sgs/registration/plane_factor.h"

namespace sgs::registration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Pair {
  Vector3d a{0.4, -0.3, 1.7}, mu{0.9, 0.2, 1.2}, n = Vector3d(0.3, -0.8, 0.4).normalized();
  SE3 T{so3_exp({0.2, -0.4, 0.3}), {0.5, 0.1, -0.3}};
  double variance_a = 2e-5, variance_b = 3e-5;
  Matrix3d C_a, C_b;
  Pair() {
    const Matrix3d Q = so3_exp({0.9, 0.2, -0.6});
    C_a = Q * Vector3d(0.02, 1, 3).asDiagonal() * Q.transpose();
    C_b = Q.transpose() * Vector3d(0.05, 1, 1.4).asDiagonal() * Q;
  }
  // Moves the target to where the source lies at T, plus an offset.
  void put_target_at(const Vector3d& offset) { mu = T * a + offset; }
};

template <class Function>
Vector6d central_difference(const SE3& T, const Function& f) {
  constexpr double h = 1e-6;
  Vector6d g;
  for (int k = 0; k < 6; ++k) {
    Vector6d xi = Vector6d::Zero();
    xi[k] = h;
    g[k] = (f(T * SE3::exp(xi)) - f(T * SE3::exp(-xi))) / (2 * h);
  }
  return g;
}

TEST(PlaneFactor, GradientAndHessianAgreeWithCentralDifferences) {
  for (const double offset : {0.004, 0.03}) {  // inside and beyond Huber's threshold
    Pair p;
    p.put_target_at(Vector3d(0.01, -0.02, 0.01) + offset * p.n);
    const PlaneFactor<double> factor{{2.5}, 100};
    ChunkSums<double> sums;
    factor.linearize(p.a, p.variance_a, p.mu, p.n, p.variance_b, p.T.R, p.T.t, sums);
    Linearization lin;
    sums.flush_into(lin);
    ASSERT_EQ(lin.inliers, 1);
    const auto cost = [&](const SE3& T) {
      return factor.error(p.a, p.variance_a, p.mu, p.n, p.variance_b, T.R, T.t);
    };
    EXPECT_NEAR(lin.error, cost(p.T), 1e-12 * lin.error);
    const Vector6d gradient = central_difference(p.T, cost);
    EXPECT_LT((2 * lin.b - gradient).norm(), 1e-5 * gradient.norm());
    // Rank one, along the residual's derivative, with the robust weight.
    const Vector6d J =
        central_difference(p.T, [&](const SE3& T) { return p.n.dot(p.mu - T * p.a); });
    const double e = std::abs(p.n.dot(p.mu - p.T * p.a)) / std::sqrt(5e-5);
    const double w = factor.robust.weight(e) / 5e-5;
    EXPECT_LT((lin.H - w * J * J.transpose()).norm(), 1e-6 * lin.H.norm());
  }
}

TEST(PlaneFactor, VanishesAtTruthAndRejectsOutliers) {
  Pair p;
  p.put_target_at(Vector3d::Zero());
  const PlaneFactor<double> factor{{2.5}, 10};
  ChunkSums<double> sums;
  factor.linearize(p.a, p.variance_a, p.mu, p.n, p.variance_b, p.T.R, p.T.t, sums);
  Linearization lin;
  sums.flush_into(lin);
  EXPECT_LT(lin.error, 1e-20);
  EXPECT_LT(lin.b.norm(), 1e-9);
  EXPECT_EQ(lin.inliers, 1);

  p.put_target_at(0.08 * p.n);  // 11 sigma
  factor.linearize(p.a, p.variance_a, p.mu, p.n, p.variance_b, p.T.R, p.T.t, sums);
  Linearization outlier;
  sums.flush_into(outlier);
  EXPECT_EQ(outlier.inliers, 0);
  EXPECT_EQ(outlier.H.norm(), 0);
  EXPECT_DOUBLE_EQ(outlier.error, factor.robust.cost(10));
}

TEST(GicpFactor, GradientAndHessianAgreeWithCentralDifferences) {
  for (const double scale : {1.0, 20.0}) {  // inside and beyond Huber's threshold
    Pair p;
    p.put_target_at(scale * Vector3d(0.05, -0.1, 0.08));
    const GicpFactor<double> factor;
    ChunkSums<double> sums;
    factor.linearize(p.a, p.C_a, p.mu, p.C_b, p.T.R, p.T.t, sums);
    Linearization lin;
    sums.flush_into(lin);
    // Gauss-Newton holds Sigma fixed; the reference does the same in world coordinates.
    const Matrix3d W = (p.C_b + p.T.R * p.C_a * p.T.R.transpose()).inverse();
    const auto distance = [&](const SE3& T) {
      const Vector3d d = p.mu - T * p.a;
      return std::sqrt(d.dot(W * d));
    };
    EXPECT_NEAR(lin.error, factor.robust.cost(distance(p.T)), 1e-10 * lin.error);
    const Vector6d gradient =
        central_difference(p.T, [&](const SE3& T) { return factor.robust.cost(distance(T)); });
    EXPECT_LT((2 * lin.b - gradient).norm(), 1e-5 * gradient.norm());
    Eigen::Matrix<double, 3, 6> J;
    for (int axis = 0; axis < 3; ++axis) {
      J.row(axis) = central_difference(p.T, [&](const SE3& T) { return (p.mu - T * p.a)[axis]; });
    }
    const Matrix6d H = factor.robust.weight(distance(p.T)) * J.transpose() * W * J;
    EXPECT_LT((lin.H - H).norm(), 1e-6 * H.norm());
    EXPECT_LT((lin.H - lin.H.transpose()).norm(), 1e-12 * H.norm());
  }
}

TEST(GicpFactor, ErrorIsSymmetricUnderSwappingTheClouds) {
  Pair p;
  p.put_target_at({0.05, -0.1, 0.08});
  const GicpFactor<double> factor;
  const SE3 inverse = p.T.inverse();
  EXPECT_NEAR(factor.error(p.a, p.C_a, p.mu, p.C_b, p.T.R, p.T.t),
              factor.error(p.mu, p.C_b, p.a, p.C_a, inverse.R, inverse.t), 1e-10);
}

TEST(GicpFactor, PlanarEllipsesReduceToPointToPlane) {
  // Both ellipses are flat along the same direction: for a vanishing floor only the distance along
  // the normal counts, with the sum of both floors as variance.
  Pair p;
  p.put_target_at(0.0005 * p.n + Vector3d(0.001, 0.002, -0.001));
  const double floor = 1e-7;
  const auto flat = [&](const Vector3d& n) -> Matrix3d {
    return Matrix3d::Identity() - (1 - floor) * n * n.transpose();
  };
  const GicpFactor<double> gicp{{1e9}, 1e9};
  const PlaneFactor<double> plane{{1e9}, 1e9};
  ChunkSums<double> a, b;
  gicp.linearize(p.a, flat(p.T.R.transpose() * p.n), p.mu, flat(p.n), p.T.R, p.T.t, a);
  plane.linearize(p.a, floor, p.mu, p.n, floor, p.T.R, p.T.t, b);
  Linearization g, q;
  a.flush_into(g);
  b.flush_into(q);
  EXPECT_NEAR(g.error, q.error, 1e-4 * q.error);
  EXPECT_LT((g.H - q.H).norm(), 1e-5 * q.H.norm());
  EXPECT_LT((g.b - q.b).norm(), 1e-4 * q.b.norm());
}

TEST(ChunkSums, FlushStartsAfresh) {
  ChunkSums<float> sums;
  const float J[6] = {1, 2, 3, 4, 5, 6};
  sums.add(J, 0.5f, 2.0f);
  Linearization total;
  sums.flush_into(total);
  const Matrix6d once = total.H;
  EXPECT_EQ(once(2, 4), 2 * 3 * 5);
  EXPECT_EQ(once, once.transpose());
  sums.add(J, 0.5f, 2.0f);
  sums.flush_into(total);
  EXPECT_EQ(total.H, 2 * once);
}

}  // namespace
}  // namespace sgs::registration
