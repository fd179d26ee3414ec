// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/merge_layers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sgs/core/error.h"
#include "sgs/core/random.h"
#include "sgs/mapper/move_map.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {
namespace {

constexpr float kSpacing_m = 0.02f;
constexpr int kSide = 40;

SE3 shifted(double x, double y, double z) {
  SE3 T;
  T.t = {x, y, z};
  return T;
}

/// Adds a wall of kSide x kSide Gaussians at `z`, as keyframe `keyframe` measured it.
void add_wall(std::int32_t keyframe, float z, float grey, std::uint64_t seed,
              map::GaussianStore& store) {
  SplitMix64 random(seed);
  const auto jitter = [&](float size) { return size * static_cast<float>(random.uniform() - 0.5); };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      map::Gaussian g{};
      g.mean[0] = kSpacing_m * static_cast<float>(x - kSide / 2) + jitter(0.5f * kSpacing_m);
      g.mean[1] = kSpacing_m * static_cast<float>(y - kSide / 2) + jitter(0.5f * kSpacing_m);
      g.mean[2] = z + jitter(0.004f);
      for (int k = 0; k < 3; ++k) {
        g.log_scale[k] = std::log((k < 2 ? 0.8f : 0.2f) * kSpacing_m);
        g.rgb[k] = grey;
      }
      g.rotation[0] = 1;
      g.opacity_logit = 1;
      map::Anchor anchor;
      anchor.point = {g.mean[0], g.mean[1], g.mean[2]};
      anchor.normal = {0, 0, -1};
      anchor.sigma_n_m = 0.003f;
      anchor.keyframe = keyframe;
      store.append(g, anchor, 0);
    }
  }
}

struct Merged {
  std::size_t count = 0;
  map::GaussianStore store;
};

/// Keyframe 1 saw the wall 5 cm behind where keyframe 0 saw it, and moves there.
Merged merge_walls(float grey_of_second, const MergeConfig& config = {},
                   const SE3& move = shifted(0, 0, -0.05)) {
  Merged out;
  add_wall(0, 1, 0.5f, 1, out.store);
  add_wall(1, 1.05f, grey_of_second, 2, out.store);
  const std::vector<SE3> moves{SE3{}, move};
  move_gaussians(moves, out.store);
  map::GaussianSet removed;
  out.count = merge_layers(moves, config, out.store, removed);
  EXPECT_EQ(removed.count(), out.count);
  out.store.remove_if([&](std::size_t i) { return removed.contains(i); });
  return out;
}

TEST(MergeLayers, WhatAMoveLaysOnEachOtherBecomesOne) {
  const Merged merged = merge_walls(0.52f);
  EXPECT_GT(merged.count, kSide * kSide * 7 / 10);
  EXPECT_EQ(merged.store.size(), 2 * kSide * kSide - merged.count);
}

TEST(MergeLayers, ThePictureStays) {
  const PinholeCamera camera{96, 72, 120, 120, 47.5, 35.5};
  map::GaussianStore alone, twice;
  add_wall(0, 1, 0.5f, 1, alone);
  twice = alone;
  add_wall(1, 1.05f, 0.52f, 2, twice);
  move_gaussians(std::vector<SE3>{SE3{}, shifted(0, 0, -0.05)}, twice);
  const auto rasterizer = render::make_cpu_rasterizer(nullptr);
  const auto alphas = [&](const map::GaussianStore& store) {
    render::Rendering r;
    rasterizer->render(store.raw, camera, SE3{}, r);
    return std::vector<float>(r.alpha.data(), r.alpha.data() + r.alpha.size());
  };
  const auto one = alphas(alone), two = alphas(twice), merged = alphas(merge_walls(0.52f).store);
  double change = 0;
  for (std::size_t i = 0; i < two.size(); ++i) {
    change += std::abs(double{two[i]} - double{merged[i]}) / static_cast<double>(two.size());
    ASSERT_GT(merged[i], one[i] - 0.02f) << "no hole where one layer has none";
  }
  EXPECT_LT(change, 0.01);
}

TEST(MergeLayers, OthersStay) {
  EXPECT_EQ(merge_walls(0.9f).count, 0u) << "of another colour";
  EXPECT_EQ(merge_walls(0.5f, {}, shifted(0, 0, -0.02)).count, 0u) << "still 3 cm apart";
  MergeConfig config;
  config.apart_m = 0.1;
  EXPECT_EQ(merge_walls(0.5f, config).count, 0u) << "was not apart";

  map::GaussianStore store;
  add_wall(0, 1, 0.5f, 1, store);
  add_wall(0, 1, 0.5f, 2, store);
  add_wall(-1, 1, 0.5f, 3, store);
  map::GaussianSet removed;
  EXPECT_EQ(merge_layers(std::vector<SE3>{shifted(1, 0, 0)}, {}, store, removed), 0u)
      << "of one keyframe, or of none";
  store.anchors[3].keyframe = 7;
  EXPECT_THROW(merge_layers(std::vector<SE3>{SE3{}}, {}, store, removed), ContractViolation);
}

TEST(MergeLayers, WhatIsAsOpaqueAsCanBeStaysSo) {
  map::GaussianStore store;
  add_wall(0, 1, 0.5f, 1, store);
  add_wall(1, 1.05f, 0.5f, 2, store);
  for (map::Gaussian& g : store.raw) g.opacity_logit = 30;  // 1 in float
  const std::vector<SE3> moves{SE3{}, shifted(0, 0, -0.05)};
  move_gaussians(moves, store);
  map::GaussianSet removed;
  EXPECT_GT(merge_layers(moves, {}, store, removed), 0u);
  for (const map::Gaussian& g : store.raw) ASSERT_EQ(g.opacity_logit, 30);
}

TEST(MergeLayers, WhatIsNotANumberIsLeftToPruning) {
  map::GaussianStore store;
  add_wall(0, 1, 0.5f, 1, store);
  add_wall(1, 1.05f, 0.5f, 2, store);
  store.raw[kSide * kSide].mean[0] = NAN;
  store.raw[kSide * kSide + 1].log_scale[0] = INFINITY;
  const std::vector<SE3> moves{SE3{}, shifted(0, 0, -0.05)};
  move_gaussians(moves, store);
  map::GaussianSet removed;
  EXPECT_GT(merge_layers(moves, {}, store, removed), 0u);
  EXPECT_FALSE(removed.contains(kSide * kSide) || removed.contains(kSide * kSide + 1));
}

}  // namespace
}  // namespace sgs::mapper
