// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/camera_path.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace sgs::run {
namespace {

/// A walk along x with a hand that shakes up and down.
Trajectory shaking_walk() {
  Trajectory walk;
  for (int i = 0; i < 90; ++i) {
    const double shake = i % 2 == 0 ? 0.01 : -0.01;
    walk.push_back({i / 30.0, {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.01 * i, shake, 0)}});
  }
  return walk;
}

TEST(SmoothPath, FollowsTheWayWithoutTheShake) {
  const auto views = smooth_path(shaking_walk(), 31);
  ASSERT_EQ(views.size(), 31u);
  for (std::size_t i = 5; i < 26; ++i) {
    EXPECT_NEAR(views[i].t.x(), 0.89 * static_cast<double>(i) / 30, 0.01);
    EXPECT_LT(std::abs(views[i].t.y()), 0.002);
    EXPECT_TRUE(views[i].R.isApprox(Eigen::Matrix3d::Identity(), 1e-6));
  }
  EXPECT_TRUE(smooth_path({}, 10).empty());
}

/// A disc of 10 cm that faces `normal`.
map::Gaussian disc(const Eigen::Vector3d& normal) {
  map::Gaussian g;
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal);
  g.rotation[0] = static_cast<float>(q.w());
  for (int k = 0; k < 3; ++k) g.rotation[k + 1] = static_cast<float>(q.vec()[k]);
  for (int k = 0; k < 3; ++k) g.log_scale[k] = std::log(k < 2 ? 0.1f : 0.001f);
  return g;
}

TEST(LevelUp, IsWhereFloorAndDeskFace) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.9, -0.45).normalized();
  const Eigen::Vector3d wall = up.unitOrthogonal();
  const Eigen::Vector3d guess(0, -1, 0);  // a camera that looks down by 28 degrees
  std::vector<map::Gaussian> room;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d off =
        0.1 * Eigen::Vector3d(std::sin(i), std::sin(1.7 * i), std::sin(2.3 * i));
    room.push_back(disc((i % 2 == 0 ? 1 : -1) * (up + off)));
    room.push_back(disc(wall + off));
    room.push_back(disc(up.cross(wall) + off));
  }
  EXPECT_GT(level_up(room, guess).dot(up), std::cos(0.04));
  EXPECT_EQ(level_up(std::vector{disc({0, 0, 1})}, guess), guess);  // nothing level in sight
  EXPECT_EQ(level_up({}, guess), guess);
}

TEST(Turntable, GoesOnceAroundTheMiddleOfTheMap) {
  std::vector<map::Gaussian> gaussians(3);
  for (std::size_t i = 0; i < 3; ++i) gaussians[i].mean[2] = 2.0f + 0.1f * static_cast<float>(i);
  const Eigen::Vector3d up(0, -1, 0), middle(0, 0, 2.1f);
  const auto views = turntable(shaking_walk(), gaussians, up, 8);
  ASSERT_EQ(views.size(), 8u);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SE3& view : views) {
    const Eigen::Vector3d in_view = view.inverse() * middle;
    EXPECT_NEAR(in_view.x(), 0, 1e-9);
    EXPECT_NEAR(in_view.y(), 0, 1e-9);
    EXPECT_GT(in_view.z(), 2);
    EXPECT_LT(view.R.col(1).dot(up), -0.9);  // upright
    EXPECT_NEAR(view.R.determinant(), 1, 1e-9);
    mean += view.t / 8;
  }
  EXPECT_NEAR((mean - middle).norm(), 0, 0.02);
  EXPECT_TRUE(turntable({}, gaussians, up, 8).empty());
}

}  // namespace
}  // namespace sgs::run
