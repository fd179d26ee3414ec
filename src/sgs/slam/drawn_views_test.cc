// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/drawn_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace sgs::slam {
namespace {

using Eigen::Vector3d;

constexpr PinholeCamera kCamera{160, 120, 135, 135, 79.5, 59.5};
constexpr double kHalf_m = 2;  // of a room of four walls and no more; z is up

/// Level, towards (cos yaw, sin yaw, 0).
SE3 looking(double yaw, const Vector3d& from) {
  const Vector3d forward(std::cos(yaw), std::sin(yaw), 0), down(0, 0, -1);
  Eigen::Matrix3d R;
  R << down.cross(forward), down, forward;
  return SE3(R, from);
}

/// What a camera in the room sees: walls of wide waves.
RgbdFrame see(const SE3& T_world_camera) {
  RgbdFrame frame;
  frame.camera = kCamera;
  frame.color = ColorImage(kCamera.width, kCamera.height);
  frame.depth = DepthImage(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Vector3d d = T_world_camera.R * kCamera.back_project(u, v, 1.0);
      const Vector3d& o = T_world_camera.t;
      double z = 1e9;
      for (int k = 0; k < 2; ++k) z = std::min(z, (std::copysign(kHalf_m, d[k]) - o[k]) / d[k]);
      const Vector3d p = o + z * d;
      const auto g = static_cast<std::uint8_t>(
          128 + 60 * std::sin(5 * p.x() + 1) * std::cos(5 * p.y()) + 40 * std::sin(7 * p.z()));
      frame.color(u, v) = {g, g, g};
      frame.depth(u, v) = static_cast<float>(z);
    }
  }
  return frame;
}

std::vector<alignment::KnownView> drawn(const std::vector<SE3>& taken, bool with_depth = true,
                                        std::size_t most = 150) {
  DrawnViews views(kCamera, taken.size(), most);
  for (const SE3& T : taken) {
    alignment::KnownView view;
    view.T_world_camera = T;
    view.frame = see(T);
    if (!with_depth) view.frame.depth.fill(0);
    views.know(view);
  }
  std::vector<alignment::KnownView> out;
  views.draw([&](const alignment::KnownView& v) { out.push_back(v); });
  return out;
}

// From the west end of the room, over an arc to the east.
std::vector<SE3> arc() {
  std::vector<SE3> out;
  for (double yaw = -1.2; yaw <= 1.2; yaw += 0.3) out.push_back(looking(yaw, {-1.5, 0, 0}));
  return out;
}

TEST(DrawnViews, ShowWhatACameraWouldSeeThere) {
  const auto views = drawn(arc());
  ASSERT_GT(views.size(), 5u);
  for (const alignment::KnownView& v : views) {
    EXPECT_TRUE(v.drawn);
    EXPECT_NEAR(v.T_world_camera.R.col(1).z(), -1, 1e-6) << "upright";
    ASSERT_LT(v.T_world_camera.t.head<2>().cwiseAbs().maxCoeff(), kHalf_m) << "in the room";
    const RgbdFrame truth = see(v.T_world_camera);
    int shown = 0, wrong = 0;
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        if (!v.frame.sees(x, y)) continue;
        ++shown;
        const double dz = std::abs(static_cast<double>(v.frame.depth(x, y) - truth.depth(x, y)));
        const int dg = std::abs(v.frame.color(x, y).r - truth.color(x, y).r);
        wrong += dz > 0.03 * static_cast<double>(truth.depth(x, y)) || dg > 25 ? 1 : 0;
      }
    }
    EXPECT_GT(shown, 0.25 * kCamera.width * kCamera.height);
    EXPECT_LT(wrong, 0.03 * shown);
  }
}

TEST(DrawnViews, AreNotOfWhatAViewShowsAnyway) {
  for (const alignment::KnownView& v : drawn(arc())) {
    for (const SE3& T : arc()) {
      const SE3 apart = T.inverse() * v.T_world_camera;
      EXPECT_TRUE(apart.t.norm() > 0.3 || apart.angle() > 0.3);
    }
  }
}

// The west wall is behind all cameras: whoever looks there sees nothing that is known.
TEST(DrawnViews, WhereTheMapShowsNothingNothingIsDrawn) {
  for (const alignment::KnownView& v : drawn(arc())) {
    EXPECT_GT(v.T_world_camera.R.col(2).x(), -0.9);
  }
  EXPECT_TRUE(drawn(arc(), false).empty());
  EXPECT_TRUE(drawn({}).empty());
}

TEST(DrawnViews, AreNoMoreThanAsked) {
  EXPECT_EQ(drawn(arc(), true, 2).size(), 2u);
  EXPECT_TRUE(drawn(arc(), true, 0).empty());
}

}  // namespace
}  // namespace sgs::slam
