// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/inverse_depth_field.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::registration {
namespace {

constexpr PinholeCamera kFieldCamera{320, 240, 270, 270, 159.5, 119.5};
constexpr double kCreaseColumn = 160;

/// The corner between two walls, seen from inside: inverse depth falls towards it from both sides.
double two_walls(double u) { return 0.4 + 0.0008 * std::abs(u - kCreaseColumn); }

DepthImage corner_of_a_room() {
  DepthImage depth(kFieldCamera.width, kFieldCamera.height);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) depth(u, v) = static_cast<float>(1 / two_walls(u));
  }
  return depth;
}

TEST(InverseDepthField, FollowsWallsUpToTheBorder) {
  const InverseDepthField field(corner_of_a_room(), kFieldCamera);
  for (const double u : {12.5, 40.0, 100.25, 140.0, 230.75, 307.0}) {
    for (const double v : {12.0, 120.5, 227.0}) {
      const InverseDepthPlane plane = field.at(u, v);
      ASSERT_GT(plane.q, 0) << u << " " << v;
      EXPECT_NEAR(plane.q, two_walls(u), 1e-5) << u << " " << v;
      EXPECT_NEAR(plane.slope_u, u < kCreaseColumn ? -0.0008 : 0.0008, 1e-5);
      EXPECT_NEAR(plane.slope_v, 0, 1e-5);
    }
  }
}

// What a window says there is the mean of two walls, and in a room's corners always too near.
TEST(InverseDepthField, SaysNothingWhereTwoWallsMeet) {
  const InverseDepthField field(corner_of_a_room(), kFieldCamera);
  int known = 0;
  for (int u = 20; u < 300; ++u) {
    const InverseDepthPlane plane = field.at(u, 100);
    if (plane.q <= 0) continue;
    ++known;
    EXPECT_NEAR(plane.q, two_walls(u), 3e-4) << u;
  }
  EXPECT_EQ(field.at(kCreaseColumn, 100).q, 0);
  EXPECT_GT(known, 240);
}

TEST(InverseDepthField, IsEmptyWhereNothingIsMeasured) {
  DepthImage depth(kFieldCamera.width, kFieldCamera.height);
  EXPECT_EQ(InverseDepthField(depth, kFieldCamera).at(100, 100).q, 0);
  EXPECT_EQ(InverseDepthField().at(3, 3).q, 0);
}

}  // namespace
}  // namespace sgs::registration
