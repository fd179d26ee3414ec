// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/move_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/core/random.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {
namespace {

const PinholeCamera kCamera{96, 72, 80, 81, 47.5, 35.5};

SE3 pose(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return SE3::exp(xi);
}

map::GaussianStore cloud(std::int32_t keyframe) {
  SplitMix64 random(3);
  map::GaussianStore store;
  const auto number = [&](double lo, double hi) {
    return static_cast<float>(lo + (hi - lo) * random.uniform());
  };
  for (int i = 0; i < 400; ++i) {
    map::Gaussian g{};
    const float size = number(-4.5, -2.5);
    for (int k = 0; k < 3; ++k) {
      g.mean[k] = k < 2 ? number(-1, 1) : number(1.5, 3);
      g.log_scale[k] = size + number(-1, 0);
      g.rgb[k] = number(0, 1);
    }
    for (float& q : g.rotation) q = number(-1, 1);
    g.opacity_logit = 1;
    map::Anchor anchor;
    anchor.point = {g.mean[0], g.mean[1], g.mean[2]};
    anchor.normal = Eigen::Vector3f(0, 0, -1);
    anchor.keyframe = keyframe;
    store.append(g, anchor, 0);
  }
  return store;
}

TEST(MoveGaussians, WhatMovesWithTheCameraLooksTheSame) {
  map::GaussianStore store = cloud(0);
  const auto rasterizer = render::make_cpu_rasterizer(nullptr);
  render::Rendering before, after;
  rasterizer->render(store.raw, kCamera, SE3{}, before);
  const SE3 move = pose(0.3, -0.5, 0.2, 1, -2, 0.5);
  move_gaussians(std::vector<SE3>{move}, store);
  rasterizer->render(store.raw, kCamera, move, after);
  double worst = 0;
  for (std::size_t i = 0; i < before.alpha.size(); ++i) {
    worst =
        std::max(worst, std::abs(double{before.alpha.data()[i]} - double{after.alpha.data()[i]}));
  }
  EXPECT_LT(worst, 4e-3);
  EXPECT_LT((store.anchors[7].normal - (move.R * Eigen::Vector3d(0, 0, -1)).cast<float>()).norm(),
            1e-5f);
  for (std::size_t i = 0; i < store.size(); ++i) {
    EXPECT_EQ(store.raw[i].mean[0], store.average[i].mean[0]);
  }
}

TEST(MoveGaussians, EachFollowsItsOwnKeyframe) {
  map::GaussianStore store = cloud(1);
  const map::Gaussian before = store.raw[5];
  store.anchors[5].keyframe = 0;
  move_gaussians(std::vector<SE3>{SE3{}, pose(0, 0, 0, 1, 0, 0)}, store);
  EXPECT_EQ(store.raw[5].mean[0], before.mean[0]);
  EXPECT_NEAR(store.anchors[6].point.x(), store.raw[6].mean[0], 1e-6);
  EXPECT_THROW(move_gaussians(std::vector<SE3>{SE3{}}, store), ContractViolation);
}

TEST(MoveGaussians, TheMeanGradientTurns) {
  map::GaussianStore store = cloud(0);
  constexpr std::uint16_t kOne = 0x3f80, kHalf = 0x3f00;  // bfloat16
  store.moments[0].mean[0] = kOne;
  store.moments[0].mean_square[1] = kHalf;
  store.moments[0].mean[6] = kOne;
  move_gaussians(std::vector<SE3>{pose(0, 0, M_PI / 2, 0, 0, 0)}, store);
  EXPECT_EQ(store.moments[0].mean[1], kOne);
  EXPECT_LT(store.moments[0].mean[0] & 0x7fff, 0x3a00);  // next to nothing
  EXPECT_EQ(store.moments[0].mean[6], 0);
  EXPECT_EQ(store.moments[0].mean_square[1], 0) << "a large turn forgets the mean squares";
  store.moments[0].mean_square[1] = kHalf;
  move_gaussians(std::vector<SE3>{pose(0, 0, 0.01, 0, 0, 0)}, store);
  EXPECT_EQ(store.moments[0].mean_square[1], kHalf);
}

DepthCalibration nearer_by(double offset_per_m) {
  DepthCalibration c;
  c.camera = kCamera;
  c.grid = {2, 2};
  c.offset_per_m.assign(4, offset_per_m);
  return c;
}

TEST(ChangeDepth, LooksTheSameFromTheKeyframeAndLiesWhereTheSurfaceIs) {
  const SE3 T = pose(0.3, -0.5, 0.2, 1, -2, 0.5);
  map::GaussianStore store = cloud(0);
  move_gaussians(std::vector<SE3>{T}, store);
  const auto rasterizer = render::make_cpu_rasterizer(nullptr);
  render::Rendering before, after;
  rasterizer->render(store.raw, kCamera, T, before);
  change_depth(std::vector<SE3>{T}, DepthChange({}, nearer_by(0.05)), store);
  rasterizer->render(store.raw, kCamera, T, after);
  double mean = 0;
  for (std::size_t i = 0; i < before.alpha.size(); ++i) {
    mean += std::abs(double{before.alpha.data()[i]} - double{after.alpha.data()[i]});
  }
  // What is thick along the ray keeps its size in the picture, not its depth in the sums.
  EXPECT_LT(mean / static_cast<double>(before.alpha.size()), 4e-3);
  map::GaussianStore original = cloud(0);
  for (std::size_t i = 0; i < store.size(); ++i) {
    const Eigen::Vector3d p(store.raw[i].mean[0], store.raw[i].mean[1], store.raw[i].mean[2]);
    const double z = (T.inverse() * p).z(), was = double{original.raw[i].mean[2]};
    ASSERT_NEAR(1 / z, 1 / was + 0.05, 1e-5);
    ASSERT_NEAR(double{store.raw[i].log_scale[1]},
                double{original.raw[i].log_scale[1]} + std::log(z / was), 1e-5);
    ASSERT_LT((store.anchors[i].point.cast<double>() - p).norm(), 1e-5);
  }
}

TEST(ChangeDepth, GaussiansOfNoKeyframeStay) {
  map::GaussianStore store = cloud(-1);
  const float before = store.raw[5].mean[2];
  change_depth({}, DepthChange({}, nearer_by(0.05)), store);
  EXPECT_EQ(store.raw[5].mean[2], before);
  store.anchors[5].keyframe = 2;
  EXPECT_THROW(change_depth(std::vector<SE3>{SE3{}}, DepthChange({}, nearer_by(0.05)), store),
               ContractViolation);
}

}  // namespace
}  // namespace sgs::mapper
