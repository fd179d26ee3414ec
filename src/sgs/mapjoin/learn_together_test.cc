// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/learn_together.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sgs/mapjoin/test_walls.h"

namespace sgs::mapjoin {
namespace {

constexpr int kWalk = 4;

Part dim_walk() {
  Part part = walk_along_wall("a walk", 0, kWalk, SE3{});
  for (map::Gaussian& g : part.gaussians.splats.gaussians) {
    std::fill(g.rgb, g.rgb + 3, 0.05f);
    g.opacity_logit = 5;  // else views would have no colour there
  }
  return part;
}

Part learned(int threads) {
  Part part = dim_walk();
  ThreadPool pool(threads);
  EXPECT_GT(learn_together(part, pool), kWalk);
  return part;
}

/// How far the Gaussian in the middle of the first view is off its colour there.
double error(const Part& part) {
  const map::Gaussian& g = part.gaussians.splats.gaussians.front();
  const ColorImage& seen = part.view(0).frame.color;
  const double there = seen(seen.width() / 2, seen.height() / 2).g / 255.0;
  return std::abs(g.rgb[1] * map::opacity(g) - there);
}

TEST(LearnTogether, GaussiansComeToLookLikeTheViewsAndKeepTheirBirths) {
  const Part before = dim_walk(), after = learned(1);
  EXPECT_LT(error(after), 0.85 * error(before));
  ASSERT_FALSE(after.gaussians.splats.gaussians.empty());
  ASSERT_EQ(after.gaussians.born_s.size(), after.gaussians.splats.gaussians.size());
  for (std::size_t i = 0; i < after.gaussians.born_s.size(); ++i) {
    // Each still lies where its view, a step of 15 cm along, has put it.
    EXPECT_NEAR(after.gaussians.splats.gaussians[i].mean[0], 0.15 * after.gaussians.born_s[i],
                0.05);
  }
  // The path is not this one's to judge.
  for (std::size_t i = 0; i < kWalk; ++i) {
    EXPECT_EQ(after.T_world_camera[i].t, before.T_world_camera[i].t);
  }
  EXPECT_EQ(after.graph.T_map_camera.size(), before.graph.T_map_camera.size());
}

TEST(LearnTogether, ThreadsChangeNothing) {
  const Part one = learned(1), three = learned(3);
  const auto &a = one.gaussians.splats.gaussians, &b = three.gaussians.splats.gaussians;
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(map::Gaussian)), 0);
}

}  // namespace
}  // namespace sgs::mapjoin
