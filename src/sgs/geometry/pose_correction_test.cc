// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/geometry/pose_correction.h"

#include <gtest/gtest.h>

#include "sgs/core/error.h"

namespace sgs {
namespace {

SE3 pose(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return SE3::exp(xi);
}

void expect_same(const SE3& a, const SE3& b) { EXPECT_LT((a.inverse() * b).log().norm(), 1e-9); }

TEST(PoseCorrection, NothingMovesWithoutPoses) {
  const SE3 T = pose(0.1, 0.2, 0.3, 1, 2, 3);
  expect_same(PoseCorrection().corrected(T, 5), T);
}

TEST(PoseCorrection, CamerasMoveWithTheirNeighboursInTime) {
  const SE3 A = pose(0, 0, 0.2, 1, 0, 0), B = pose(0, 0.1, 0, 0, 1, 0);
  const SE3 T1 = pose(0.3, 0, 0, 4, 0, 0), T2 = pose(0, 0.4, 0, 0, 5, 0);
  const PoseCorrection c({{1, T1, A * T1}, {3, T2, B * T2}});
  const SE3 T = pose(0.5, 0.2, 0.1, 1, 1, 1);
  expect_same(c.corrected(T1, 1), A * T1);
  expect_same(c.corrected(T, 0), A * T);
  expect_same(c.corrected(T, 4), B * T);
  expect_same(c.corrected(T, 2.5), interpolate(A * T, B * T, 0.75));
  EXPECT_NEAR(c.largest_rotation_rad(), 0.2, 1e-9);
}

TEST(PoseCorrection, DoesNotDependOnTheWorld) {
  const SE3 W = pose(0.4, -0.3, 0.2, 100, -50, 20);
  const SE3 T1 = pose(0.3, 0, 0, 4, 0, 0), T2 = pose(0, 0.4, 0, 0, 5, 0);
  const SE3 T1_after = pose(0, 0, 0.2, 1, 0, 0) * T1;
  const PoseCorrection here({{1, T1, T1_after}, {3, T2, T2}});
  const PoseCorrection there({{1, W * T1, W * T1_after}, {3, W * T2, W * T2}});
  const SE3 T = pose(0.5, 0.2, 0.1, 1, 1, 1);
  expect_same(there.corrected(W * T, 1.7), W * here.corrected(T, 1.7));
}

// A long recording is corrected hundreds of times, each time from where the last one has left it.
TEST(PoseCorrection, ManyInARowLeaveARotation) {
  SE3 first = pose(0.3, -0.2, 0.1, 4, 0, 0), last = pose(0, 0.4, 0.7, 0, 5, 0);
  for (int i = 0; i < 500; ++i) {
    const SE3 step = pose(1e-4 * (i % 3 - 1), 2e-4, -1e-4 * (i % 5), 1e-3, -1e-3, 0);
    const PoseCorrection c(
        {{1, first, (step * first).normalized()}, {3, last, (last * step).normalized()}});
    first = c.corrected(first, 1);
    last = c.corrected(last, 3);
  }
  for (const SE3& T : {first, last}) {
    EXPECT_LT((T.R * T.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  }
}

TEST(PoseCorrection, TimesRise) {
  EXPECT_THROW(PoseCorrection({{1, {}, {}}, {1, {}, {}}}), ContractViolation);
}

}  // namespace
}  // namespace sgs
