// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/robot/smooth_odometry.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace sgs::robot {
namespace {

SE3 at(double x, double yaw) {
  return {Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix(), {x, 0.1, 0.2 * x}};
}

void expect_near(const SE3& a, const SE3& b, double most = 1e-12) {
  EXPECT_LT((a.t - b.t).norm(), most);
  EXPECT_LT((a.R - b.R).norm(), most);
}

/// A tenth of a metre and a twentieth of a radian a frame, ten frames a second.
history::Path walk(std::int64_t frames) {
  history::Path path;
  for (std::int64_t k = 0; k < frames; ++k) {
    const auto n = static_cast<double>(k);
    path.append({k, 0.1 * n, at(0.1 * n, 0.05 * n)});
  }
  return path;
}

TEST(SmoothOdometry, IsThePathAsLongAsNothingIsLearned) {
  SmoothOdometry odometry;
  const history::Path path = walk(4);
  for (std::int64_t k = 0; k < 4; ++k) {
    const Standing now = odometry.step(path, k);
    expect_near(now.T_odom_camera, path.at(k), 0 + 1e-15);
    EXPECT_TRUE(now.T_map_odom.R.isIdentity(0) && now.T_map_odom.t.isZero(0));
    EXPECT_EQ(now.velocity.has_value(), k > 0);
  }
}

TEST(SmoothOdometry, TellsHowFastTheCameraIs) {
  SmoothOdometry odometry;
  const history::Path path = walk(2);
  odometry.step(path, 0);
  const Vector6d v = odometry.step(path, 1).velocity.value();
  EXPECT_NEAR(v[1], 0.5, 1e-12);
  const Eigen::Vector3d moved = path.at(1).R.transpose() * (path.at(1).t - path.at(0).t) / 0.1;
  EXPECT_LT((v.tail<3>() - moved).norm(), 1e-12);
}

TEST(SmoothOdometry, ALoopMovesTheCorrectionAlone) {
  SmoothOdometry odometry;
  history::Path path = walk(5);
  Standing before;
  for (std::int64_t k = 0; k < 4; ++k) before = odometry.step(path, k);
  const SE3 learned(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                    {1, -2, 0.5});
  history::Path revised;
  for (std::int64_t k = 0; k < 5; ++k) {
    revised.append({k, path[static_cast<std::size_t>(k)].timestamp_s, learned * path.at(k)});
  }
  const Standing now = odometry.step(revised, 4);
  expect_near(before.T_odom_camera.inverse() * now.T_odom_camera,
              path.at(3).inverse() * path.at(4));
  expect_near(now.T_map_odom * now.T_odom_camera, revised.at(4));
  expect_near(now.T_map_odom, learned);
}

TEST(SmoothOdometry, StandsStillWhileTheCameraWasLost) {
  SmoothOdometry odometry;
  const history::Path path = walk(9);
  const Standing before = odometry.step(path, 0);
  odometry.lose();
  const Standing now = odometry.step(path, 8);
  expect_near(now.T_odom_camera, before.T_odom_camera);
  expect_near(now.T_map_odom * now.T_odom_camera, path.at(8));
  EXPECT_FALSE(now.velocity.has_value());
}

}  // namespace
}  // namespace sgs::robot
