// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/geometry/trajectory.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <random>

namespace sgs {
namespace {

StampedPose pose(double time, double x) {
  return {time, SE3(Eigen::Matrix3d::Identity(), {x, 0, 0})};
}

TEST(Trajectory, SortsAndKeepsTheFirstOfEqualTimes) {
  const Trajectory t({pose(3, 30), pose(1, 10), pose(3, 31), pose(2, 20)});
  ASSERT_EQ(t.size(), 3u);
  EXPECT_EQ(t.poses()[0].T_world_camera.t.x(), 10);
  EXPECT_EQ(t.poses()[2].T_world_camera.t.x(), 30);
}

TEST(Trajectory, RefusesToGoBackInTime) {
  Trajectory t;
  t.push_back(pose(1, 0));
  EXPECT_THROW(t.push_back(pose(1, 0)), ContractViolation);
  EXPECT_THROW(t.push_back(pose(std::numeric_limits<double>::quiet_NaN(), 0)), ContractViolation);
}

TEST(Trajectory, InterpolatesInsideAndNowhereElse) {
  const Trajectory t({pose(1, 10), pose(2, 20), pose(5, 50)});
  EXPECT_NEAR(t.at(1.25, 1.5)->t.x(), 12.5, 1e-12);
  EXPECT_EQ(t.at(2, 0)->t.x(), 20);
  EXPECT_EQ(t.at(5 + 5e-7, 0)->t.x(), 50);
  EXPECT_EQ(t.at(1 - 5e-7, 0)->t.x(), 10);
  EXPECT_FALSE(t.at(0.9, 10));
  EXPECT_FALSE(t.at(5.1, 10));
  EXPECT_FALSE(t.at(3, 1.5));  // the neighbours are 3 s apart
  EXPECT_FALSE(t.at(std::numeric_limits<double>::quiet_NaN(), 10));
  EXPECT_FALSE(Trajectory().at(1, 1));
}

std::vector<Eigen::Vector3d> cloud(int points, double z_scale) {
  std::mt19937_64 random(3);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  std::vector<Eigen::Vector3d> out;
  for (int i = 0; i < points; ++i) out.emplace_back(uniform(), uniform(), z_scale * uniform());
  return out;
}

std::vector<Eigen::Vector3d> moved(const std::vector<Eigen::Vector3d>& points, double scale,
                                   const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& p : points) out.push_back(scale * (R * p) + t);
  return out;
}

TEST(AlignPoints, RecoversRotationTranslationAndScale) {
  const Eigen::Matrix3d R = so3_exp({0.4, -2.0, 1.0});
  const Eigen::Vector3d t(5, -6, 7);
  for (const double z_scale : {1.0, 0.0}) {  // in space and in a plane
    const auto source = cloud(30, z_scale);
    const auto rigid = align_points(source, moved(source, 1, R, t), false);
    ASSERT_TRUE(rigid);
    EXPECT_TRUE(rigid->T_target_source.R.isApprox(R, 1e-12));
    EXPECT_TRUE(rigid->T_target_source.t.isApprox(t, 1e-12));
    EXPECT_EQ(rigid->scale, 1);
    const auto scaled = align_points(source, moved(source, 2.5, R, t), true);
    EXPECT_NEAR(scaled->scale, 2.5, 1e-12);
    EXPECT_TRUE(scaled->T_target_source.R.isApprox(R, 1e-12));
    EXPECT_TRUE(scaled->T_target_source.t.isApprox(t, 1e-11));
    EXPECT_EQ(align_points(source, moved(source, 2.5, R, t), false)->scale, 1);
  }
}

// A mirrored cloud has no exact alignment; the answer must still be a rotation, and a minimiser.
TEST(AlignPoints, ReflectionGivesTheBestRotation) {
  const auto source = cloud(40, 0.2);
  auto target = source;
  for (auto& p : target) p.z() = -p.z();
  const auto aligned = align_points(source, target, false);
  ASSERT_TRUE(aligned);
  const SE3& T = aligned->T_target_source;
  EXPECT_NEAR(T.R.determinant(), 1, 1e-12);
  const auto cost = [&](const SE3& pose_) {
    double sum = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      sum += (pose_ * source[i] - target[i]).squaredNorm();
    }
    return sum;
  };
  for (int k = 0; k < 6; ++k) {
    for (const double step : {-1e-3, 1e-3}) {
      EXPECT_GE(cost(T * SE3::exp(step * Vector6d::Unit(k))), cost(T));
    }
  }
}

TEST(AlignPoints, DegenerateInput) {
  EXPECT_FALSE(align_points({}, {}, true));
  const auto one = align_points({{1, 2, 3}}, {{4, 5, 6}}, true);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->scale, 1);
  EXPECT_TRUE(
      ((one->T_target_source * Eigen::Vector3d(1, 2, 3)) - Eigen::Vector3d(4, 5, 6)).isZero(1e-12));
  EXPECT_THROW(align_points({{1, 2, 3}}, {}, false), ContractViolation);
}

}  // namespace
}  // namespace sgs
