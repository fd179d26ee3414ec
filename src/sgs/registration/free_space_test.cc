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

constexpr int kStep_px = 4;

/// A point in the middle of each cell.
SourceCloud wall(float depth_m) {
  SourceCloud cloud;
  for (int v = kStep_px / 2; v < camera().height; v += kStep_px) {
    for (int u = kStep_px / 2; u < camera().width; u += kStep_px) {
      SourcePoint p;
      p.point = camera().back_project(u, v, double{depth_m}).cast<float>();
      p.normal = {0, 0, -1};
      p.variance_m2 = 1e-6f;
      p.u = static_cast<std::uint16_t>(u), p.v = static_cast<std::uint16_t>(v);
      cloud.points.push_back(p);
    }
  }
  return cloud;
}

Eigen::Vector3f at(double u, double v, double depth_m) {
  return camera().back_project(u, v, depth_m).cast<float>();
}

TEST(FreeSpace, LiesBeforeWhatIsMeasured) {
  const FreeSpace space(wall(2), camera(), kStep_px);
  EXPECT_TRUE(space.contains(at(80, 60, 1.8), kMargin_m));
  EXPECT_FALSE(space.contains(at(80, 60, 1.98), kMargin_m));  // within the margin
  EXPECT_FALSE(space.contains(at(80, 60, 2), kMargin_m));
  EXPECT_FALSE(space.contains(at(80, 60, 2.5), kMargin_m));
}

TEST(FreeSpace, MissesWhatLiesWhollyBehind) {
  const FreeSpace space(wall(2), camera(), kStep_px);
  EXPECT_TRUE(space.misses(at(80, 60, 3), 0.5f));
  EXPECT_FALSE(space.misses(at(80, 60, 2.2), 0.5f));
  EXPECT_FALSE(space.misses(at(80, 60, 1), 0.1f));
}

TEST(FreeSpace, EndsWithTheImage) {
  const FreeSpace space(wall(2), camera(), kStep_px);
  EXPECT_FALSE(space.contains(at(1, 60, 1), kMargin_m));
  EXPECT_FALSE(space.contains(at(-20, 60, 1), kMargin_m));
  EXPECT_FALSE(space.contains(at(80, 400, 1), kMargin_m));
  EXPECT_FALSE(space.contains({0, 0, -1}, kMargin_m));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(space.contains({nan, nan, nan}, kMargin_m));
}

// A hole may be a thin thing that was missed, and beside an edge a pixel more or less is no news.
TEST(FreeSpace, IsNotWhereSomethingNearWasSeenOrMissed) {
  SourceCloud cloud = wall(3);
  std::erase_if(cloud.points,
                [](const SourcePoint& p) { return p.u / kStep_px == 10 && p.v / kStep_px == 10; });
  for (SourcePoint& p : cloud.points) {
    if (p.u / kStep_px == 25) p.point *= 1 / p.point.z();
  }
  const FreeSpace space(cloud, camera(), kStep_px);
  EXPECT_FALSE(space.contains(at(42, 42, 1.5), kMargin_m));
  EXPECT_FALSE(space.contains(at(46, 42, 1.5), kMargin_m));  // the cell beside it
  EXPECT_FALSE(space.contains(at(105, 42, 1.5), kMargin_m));
  EXPECT_TRUE(space.contains(at(60, 42, 1.5), kMargin_m));
}

}  // namespace
}  // namespace sgs::registration
