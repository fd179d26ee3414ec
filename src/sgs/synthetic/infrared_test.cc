// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/infrared.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sgs::synthetic {
namespace {

const PinholeCamera kColorCamera{160, 120, 133.85, 134.8, 79.6, 61.5};

InfraredModel matcher() {
  InfraredModel m;
  m.camera = true;
  m.focal_ratio = 1.09;
  m.baseline_m = 0.025;
  m.dimmest = 0.01f;
  return m;
}

// One large matt surface and one screen; nothing of them but the materials is asked for.
void furnish(Scene& scene) {
  scene.primitives.resize(2);
  scene.primitives[0].half_u = scene.primitives[0].half_v = 3;
  scene.primitives[1].half_u = scene.primitives[1].half_v = 0.2f;
  scene.primitives[1].glow = 1;
}

Infrared infrared(const InfraredModel& model, const Distortion& lens = {},
                  const Eigen::Vector2d& shift = {0, 0}) {
  Scene scene;
  furnish(scene);
  return Infrared(model, scene, {}, {kColorCamera, lens}, shift, 3);
}

RayImage wall_in_infrared(float depth, float cosine = 1, std::uint16_t surface = 0) {
  const std::size_t n = static_cast<std::size_t>(kColorCamera.width * kColorCamera.height);
  return {kColorCamera.width,
          kColorCamera.height,
          std::vector<float>(n, depth),
          std::vector<float>(n, cosine),
          std::vector<std::uint16_t>(n, surface),
          {},
          std::vector<float>(n, 0.7f)};
}

double share_of_holes(const std::vector<float>& depth) {
  return static_cast<double>(std::count(depth.begin(), depth.end(), 0.f)) /
         static_cast<double>(depth.size());
}

double holes(const InfraredModel& model, const RayImage& view) {
  ThreadPool pool(1);
  return share_of_holes(infrared(model).matched(view, 0, pool).depth);
}

TEST(Infrared, FarSlantedDarkAndShiningSurfacesFail) {
  const InfraredModel m = matcher();
  EXPECT_EQ(holes(m, wall_in_infrared(1)), 0);
  EXPECT_EQ(holes(m, wall_in_infrared(4)), 0);
  EXPECT_EQ(holes(m, wall_in_infrared(3, 0.2f)), 1);     // 78 degrees
  EXPECT_EQ(holes(m, wall_in_infrared(1, 0.2f)), 0);     // but not near
  EXPECT_EQ(holes(m, wall_in_infrared(1, 0.8f, 1)), 0);  // a screen
  EXPECT_EQ(holes(m, wall_in_infrared(2.5f, 0.8f, 1)), 1);
  EXPECT_EQ(holes(m, wall_in_infrared(1, 1, 1)), 1);  // mirrors the projector
}

TEST(Infrared, FailuresComeInPatches) {
  InfraredModel m = matcher();
  m.patchiness = 0.7f;
  const RayImage view = wall_in_infrared(1.8f, 0.8f, 1);  // about as dim as the limit
  ThreadPool pool(1);
  const auto depth = infrared(m).matched(view, 0, pool).depth;
  const double share = share_of_holes(depth);
  EXPECT_GT(share, 0.15);
  EXPECT_LT(share, 0.85);
  int changes = 0;
  for (std::size_t i = 1; i < depth.size(); ++i)
    changes += (depth[i] > 0) != (depth[i - 1] > 0) ? 1 : 0;
  // Alone, pixels would change in 2 share (1 - share) of the places.
  EXPECT_LT(static_cast<double>(changes) / static_cast<double>(depth.size()),
            0.7 * 2 * share * (1 - share));
}

// Near on the left of column 80, far on the right.
RayImage step_in_infrared() {
  RayImage view = wall_in_infrared(1);
  for (std::size_t i = 0; i < view.depth.size(); ++i)
    if (i % 160 >= 80) view.depth[i] = 2;
  return view;
}

TEST(Infrared, SilhouettesAreRaggedLoseDepthAndMixIt) {
  ThreadPool pool(1);
  InfraredModel m = matcher();
  EXPECT_EQ(infrared(m).matched(step_in_infrared(), 0, pool).depth, step_in_infrared().depth);
  m.ragged_px = 1;
  int moved = 0;
  const auto ragged = infrared(m).matched(step_in_infrared(), 0, pool).depth;
  for (std::size_t i = 0; i < ragged.size(); ++i) {
    moved += ragged[i] != step_in_infrared().depth[i] ? 1 : 0;
    EXPECT_TRUE(ragged[i] == 1 || ragged[i] == 2);
  }
  EXPECT_GT(moved, 40);
  m.ragged_px = 0;
  m.flying = 0.2f;
  const auto flying = infrared(m).matched(step_in_infrared(), 0, pool).depth;
  const auto between =
      std::count_if(flying.begin(), flying.end(), [](float z) { return z > 1.01f && z < 1.99f; });
  EXPECT_NEAR(static_cast<double>(between), 0.2 * 4 * 120, 50);
  m.flying = 0;
  m.edge_limit = 0;
  EXPECT_NEAR(holes(m, step_in_infrared()), 0.5 * 4 / 160, 0.005);
}

TEST(Infrared, RegistrationPutsDepthOnWholePixels) {
  // The same place, by either camera: what the table rounds is at most half a pixel.
  const Distortion lens{0.26, -0.95, 0, 0, 1.16};
  const Infrared camera = infrared(matcher(), lens, {1, 0});
  DepthImage one(160, 120);
  one(70, 50) = 1.5f;
  const DepthImage out = camera.registered(one);
  const Eigen::Vector3d p = camera.T_color_infrared() * camera.camera().back_project(70, 50, 1.5);
  const Eigen::Vector2d bent = lens.apply(p.head<2>() / p.z());
  const double u = kColorCamera.fx * bent.x() + kColorCamera.cx + 1,
               v = kColorCamera.fy * bent.y() + kColorCamera.cy;
  EXPECT_EQ(out(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v))), 1.5f);
  EXPECT_EQ(std::count_if(out.data(), out.data() + out.size(), [](float z) { return z > 0; }), 1);
}

TEST(Infrared, SeesLessThanColour) {
  const DepthImage out = infrared(matcher()).registered(DepthImage(160, 120, 2.f));
  const auto seen =
      std::count_if(out.data(), out.data() + out.size(), [](float z) { return z > 0; });
  EXPECT_NEAR(static_cast<double>(seen) / (160 * 120), 1 / (1.09 * 1.09), 0.04);
  for (int y = 20; y < 100; ++y)
    for (int x = 20; x < 130; ++x) ASSERT_EQ(out(x, y), 2.f);  // no gap on a surface
}

}  // namespace
}  // namespace sgs::synthetic
