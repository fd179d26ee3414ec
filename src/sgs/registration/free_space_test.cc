// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/free_space.h"

#include <gtest/gtest.h>

#include <limits>

namespace sgs::registration {
namespace {

constexpr float kMargin_m = 0.03f;

PinholeCamera camera() {
  PinholeCamera c;
  c.width = 160, c.height = 120;
  c.fx = c.fy = 131;
  c.cx = 79.5, c.cy = 59.5;
  return c;
}

DepthImage wall(float depth_m) {
  DepthImage depth(camera().width, camera().height);
  for (std::size_t i = 0; i < depth.size(); ++i) depth.data()[i] = depth_m;
  return depth;
}

Eigen::Vector3f at(double u, double v, double depth_m) {
  return camera().back_project(u, v, depth_m).cast<float>();
}

TEST(FreeSpace, LiesBeforeWhatIsMeasured) {
  const FreeSpace space(wall(2), camera());
  EXPECT_TRUE(space.contains(at(80, 60, 1.8), kMargin_m));
  EXPECT_FALSE(space.contains(at(80, 60, 1.98), kMargin_m));  // within the margin
  EXPECT_FALSE(space.contains(at(80, 60, 2), kMargin_m));
  EXPECT_FALSE(space.contains(at(80, 60, 2.5), kMargin_m));
}

TEST(FreeSpace, EndsWithTheImage) {
  const FreeSpace space(wall(2), camera());
  EXPECT_FALSE(space.contains(at(1, 60, 1), kMargin_m));
  EXPECT_FALSE(space.contains(at(-20, 60, 1), kMargin_m));
  EXPECT_FALSE(space.contains(at(80, 400, 1), kMargin_m));
  EXPECT_FALSE(space.contains({0, 0, -1}, kMargin_m));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(space.contains({nan, nan, nan}, kMargin_m));
}

// A hole may be a thin thing that was missed, and beside an edge a pixel more or less is no news.
TEST(FreeSpace, IsNotWhereSomethingNearWasSeenOrMissed) {
  DepthImage depth = wall(3);
  for (int y = 40; y < 48; ++y) {
    for (int x = 40; x < 48; ++x) depth(x, y) = 0;
  }
  for (int y = 40; y < 48; ++y) depth(100, y) = 1;
  const FreeSpace space(depth, camera());
  EXPECT_FALSE(space.contains(at(44, 44, 1), kMargin_m));
  EXPECT_FALSE(space.contains(at(51, 44, 1), kMargin_m));  // the cell beside it
  EXPECT_FALSE(space.contains(at(101, 44, 1), kMargin_m));
  EXPECT_TRUE(space.contains(at(60, 44, 1), kMargin_m));
}

}  // namespace
}  // namespace sgs::registration
