// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/drawn_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace sgs::slam {
namespace {

using Eigen::Vector3d;

constexpr PinholeCamera kCamera{160, 120, 135, 135, 79.5, 59.5};
constexpr PinholeCamera kLarge{480, 360, 405, 405, 239.5, 179.5};  // is drawn at half the size
constexpr double kHalf_m = 2;  // of a room of four walls and no more; z is up

/// Level, towards (cos yaw, sin yaw, 0).
SE3 looking(double yaw, const Vector3d& from) {
  const Vector3d forward(std::cos(yaw), std::sin(yaw), 0), down(0, 0, -1);
  Eigen::Matrix3d R;
  R << down.cross(forward), down, forward;
  return SE3(R, from);
}

/// What a camera in the room sees: walls of wide waves.
RgbdFrame see(const SE3& T_world_camera, const PinholeCamera& camera = kCamera) {
  RgbdFrame frame;
  frame.camera = camera;
  frame.color = ColorImage(camera.width, camera.height);
  frame.depth = DepthImage(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d d = T_world_camera.R * camera.back_project(u, v, 1.0);
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
                                        std::size_t most = 150, int threads = 1,
                                        const PinholeCamera& camera = kCamera) {
  DrawnViews views(camera, taken.size(), most);
  for (const SE3& T : taken) {
    alignment::KnownView view;
    view.T_world_camera = T;
    view.frame = see(T, camera);
    if (!with_depth) view.frame.depth.fill(0);
    views.know(view);
  }
  std::vector<alignment::KnownView> out;
  ThreadPool pool(threads);
  views.draw(pool, [&](const alignment::KnownView& v) { out.push_back(v); });
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

// Of all patches that reach a pixel the one that was seen from nearest is one towards that view: a
// drawing of walls that were seen from opposite would be larger than what it shows, and whoever is
// aligned to it too far back.
TEST(DrawnViews, AreNotLargerThanWhatACameraWouldSee) {
  std::vector<SE3> taken;  // along the north wall
  for (double x = -1.8; x < 0; x += 0.3) taken.push_back(looking(0.3, {x, 1, 0}));
  double slope = 0, square = 0;
  for (const alignment::KnownView& v : drawn(taken, true, 40, 1, kLarge)) {
    if (v.T_world_camera.R.col(2).x() > 0) continue;
    const RgbdFrame truth = see(v.T_world_camera, kLarge);
    for (int y = 1; y + 1 < kLarge.height; ++y) {
      for (int x = 1; x + 1 < kLarge.width; ++x) {
        if (!v.frame.sees(x, y) || std::abs(v.frame.depth(x, y) - truth.depth(x, y)) > 0.1f)
          continue;
        const double outwards =
            0.5 * (truth.color(x + 1, y).r - truth.color(x - 1, y).r) * (x - kLarge.cx) +
            0.5 * (truth.color(x, y + 1).r - truth.color(x, y - 1).r) * (y - kLarge.cy);
        slope -= outwards * (v.frame.color(x, y).r - truth.color(x, y).r);
        square += outwards * outwards;
      }
    }
  }
  ASSERT_GT(square, 0);
  EXPECT_NEAR(slope / square, 0, 5e-5) << "larger by this share";
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

TEST(DrawnViews, AreTheSameForAnyNumberOfThreads) {
  const auto one = drawn(arc()), three = drawn(arc(), true, 150, 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    const RgbdFrame &a = one[i].frame, &b = three[i].frame;
    EXPECT_EQ((one[i].T_world_camera.inverse() * three[i].T_world_camera).t.norm(), 0);
    EXPECT_EQ(one[i].ferns, three[i].ferns);
    EXPECT_TRUE(std::equal(a.depth.data(), a.depth.data() + a.depth.size(), b.depth.data()));
    EXPECT_TRUE(std::equal(a.color.data(), a.color.data() + a.color.size(), b.color.data(),
                           [](const Rgb8& x, const Rgb8& y) { return x.g == y.g; }));
  }
}

}  // namespace
}  // namespace sgs::slam
