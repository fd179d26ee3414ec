// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/metre_check.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::slam {
namespace {

const PinholeCamera kMetreCamera{320, 240, 270, 270, 159.5, 119.5};

/// The inside of a ball of 2 m about (0, 0, 0.8), seen from `x_m` to the right, each depth so many
/// times as long.
RgbdFrame ball_from(double x_m, double times) {
  RgbdFrame frame;
  frame.camera = kMetreCamera;
  frame.depth = DepthImage(kMetreCamera.width, kMetreCamera.height);
  const Eigen::Vector3d to_camera(x_m, 0, -0.8);
  for (int v = 0; v < kMetreCamera.height; ++v) {
    for (int u = 0; u < kMetreCamera.width; ++u) {
      const Eigen::Vector3d ray = kMetreCamera.back_project(u, v, 1);
      const double a = ray.squaredNorm(), b = ray.dot(to_camera), c = to_camera.squaredNorm() - 4;
      frame.depth(u, v) = static_cast<float>(times * (-b + std::sqrt(b * b - a * c)) / a);
    }
  }
  return frame;
}

TEST(MetreCheck, SeesAnotherMetreThroughThePoseThatTakesItUp) {
  for (const double times : {1.0, 1.03, 0.97}) {
    history::Path path;
    path.append({-5, 0, SE3{}});
    MetreCheck check;
    check.know(-5, ball_from(0, 1));
    bool done = false;
    for (int k = 0; k < 30; ++k) {
      EXPECT_FALSE(check.ratio());
      EXPECT_FALSE(done);
      const double x = 0.003 * k;
      SE3 T;
      T.t = {x, 0, -2 * (times - 1)};  // where the middle of the picture fits
      done = check.add(ball_from(x, times), T, path);
    }
    EXPECT_TRUE(done);
    ASSERT_TRUE(check.ratio());
    EXPECT_NEAR(*check.ratio(), times, 0.004);
  }
}

// Three planes or fewer look alike from elsewhere and in another metre.
TEST(MetreCheck, SaysNothingBeforeAWall) {
  RgbdFrame wall;
  wall.camera = kMetreCamera;
  wall.depth = DepthImage(kMetreCamera.width, kMetreCamera.height);
  for (std::size_t i = 0; i < wall.depth.size(); ++i) wall.depth.data()[i] = 2;
  history::Path path;
  path.append({-5, 0, SE3{}});
  MetreCheck check;
  check.know(-5, wall);
  for (int k = 0; k < 40; ++k) check.add(wall, SE3{}, path);
  EXPECT_FALSE(check.ratio());
}

}  // namespace
}  // namespace sgs::slam
