// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/shutter.h"

#include <gtest/gtest.h>

#include "sgs/mapper/test_wall_scene.h"

namespace sgs::refine {
namespace {

map::Gaussian at(const SE3& T_world_camera, const Eigen::Vector3d& p_camera) {
  map::Gaussian g{};
  const Eigen::Vector3d p = T_world_camera * p_camera;
  for (int k = 0; k < 3; ++k) g.mean[k] = static_cast<float>(p[k]);
  return g;
}

Eigen::Vector3d mean_of(const map::Gaussian& g) { return {g.mean[0], g.mean[1], g.mean[2]}; }

/// Where the camera sees a point at the moment at which it reads the row: by iteration.
Eigen::Vector2d seen_by_rolling_shutter(const PinholeCamera& camera, const SE3& T,
                                        const Vector6d& readout, const Eigen::Vector3d& p) {
  double share = 0;
  Eigen::Vector2d pixel;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d q = (T * SE3::exp(share * readout)).inverse() * p;
    pixel = {camera.fx * q.x() / q.z() + camera.cx, camera.fy * q.y() / q.z() + camera.cy};
    share = (pixel.y() - 0.5 * (camera.height - 1)) / camera.height;
  }
  return pixel;
}

TEST(ShiftByShutter, PutsPointsWhereARollingShutterSeesThem) {
  const PinholeCamera camera = mapper::small_camera();
  Vector6d pose, readout;
  pose << 0.1, -0.2, 0.05, 0.3, 0.1, -0.2;
  readout << 0.004, 0.01, -0.003, 0.002, 0.004, -0.003;
  const SE3 T = SE3::exp(pose);
  std::vector<map::Gaussian> gaussians, shifted;
  for (const double y : {-0.7, -0.3, 0.0, 0.4, 0.8}) gaussians.push_back(at(T, {0.3, y, 2.0}));
  shift_by_shutter(gaussians, camera, T, readout, shifted, nullptr);
  ASSERT_EQ(shifted.size(), gaussians.size());
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    const Eigen::Vector3d q = T.inverse() * mean_of(shifted[i]);
    const Eigen::Vector2d drawn(camera.fx * q.x() / q.z() + camera.cx,
                                camera.fy * q.y() / q.z() + camera.cy);
    const Eigen::Vector2d seen = seen_by_rolling_shutter(camera, T, readout, mean_of(gaussians[i]));
    EXPECT_LT((drawn - seen).norm(), 0.02) << i;
  }
  const double moved = (mean_of(shifted[4]) - mean_of(gaussians[4])).norm();
  EXPECT_GT(moved, 0.005);
}

TEST(ShiftByShutter, LeavesAloneWhatLiesBehind) {
  const std::vector<map::Gaussian> behind = {at(SE3(), {0, 0.5, -1})};
  std::vector<map::Gaussian> shifted;
  shift_by_shutter(behind, mapper::small_camera(), SE3(), Vector6d::Ones(), shifted, nullptr);
  EXPECT_EQ(mean_of(shifted[0]), mean_of(behind[0]));
}

TEST(TwistAt, IsTheMotionAboutATimeWithinTheReadout) {
  Trajectory path;
  for (int i = 0; i < 4; ++i) path.push_back({0.1 * i, mapper::translated(0.05 * i, 0, 0)});
  const Vector6d twist = twist_at(path, 0.1, 0.02);
  EXPECT_NEAR(twist[3], 0.01, 1e-9);
  EXPECT_NEAR(twist.head<3>().norm(), 0, 1e-9);
  EXPECT_TRUE(twist_at(path, 0.0, 0.02).isZero());
  EXPECT_TRUE(twist_at(path, 5.0, 0.02).isZero());
}

}  // namespace
}  // namespace sgs::refine
