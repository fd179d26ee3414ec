// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "sgs/camera/depth_lag.h"
#include "sgs/history/view_store.h"
#include "sgs/mapper/test_wall_scene.h"

namespace sgs::mapper {
namespace {

/// Keyframes that come one by one, with views that are visited.
struct Keyframes {
  explicit Keyframes(std::size_t budget_bytes, std::size_t count) : store(budget_bytes, {}) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto index = static_cast<std::int64_t>(k);
      const auto T = translated(0.01 * static_cast<double>(index), 0, 0);
      all.emplace_back(KeyframeView{store.keep(*wall_frame(small_camera(), T, index)), 10}, T);
      store.note_beside(views.half_bytes(all));
      store.settle();
      views.drop_halves(store.excess_bytes(), all);
      views.get(all.back(), k, 1);
    }
  }

  std::unique_ptr<render::Rasterizer> rasterizer = render::make_cpu_rasterizer(nullptr);
  TrainingViewCache views{*rasterizer, 2};
  history::ViewStore store;
  std::vector<MapKeyframe> all;
};

TEST(MapKeyframe, ShowsTheSameFromTheDisk) {
  Keyframes tight(1, 100), wide(std::size_t{1} << 40, 100);
  EXPECT_EQ(wide.views.first_half_kept(), 0u);
  EXPECT_EQ(tight.views.first_half_kept(), 100u - 64u);
  EXPECT_EQ(wide.store.reads(), 0u);
  for (std::size_t i = 0; i < 100; ++i) {
    const auto a = tight.all[i].pictures(), b = wide.all[i].pictures();
    ASSERT_TRUE(a && b);
    const std::size_t color_bytes = a->color().size() * sizeof(Rgb8);
    EXPECT_EQ(std::memcmp(a->color().data(), b->color().data(), color_bytes), 0);
    EXPECT_EQ(std::memcmp(a->depth.data(), b->depth.data(), a->depth.size() * sizeof(float)), 0);
    EXPECT_TRUE(tight.views.get(tight.all[i], i, 0));
    EXPECT_TRUE(tight.views.get(tight.all[i], i, 1));
  }
  EXPECT_GT(tight.store.reads(), 0u);
}

TEST(MapKeyframe, ACulledOneKeepsNothingButItsPose) {
  Keyframes keyframes(std::size_t{1} << 40, 2);
  const std::size_t before = keyframes.store.bytes_in_memory();
  keyframes.all[0].pose_information = std::make_shared<Matrix6d>(Matrix6d::Identity());
  keyframes.all[0].cull();
  EXPECT_EQ(keyframes.all[0].pose_information, nullptr);
  EXPECT_EQ(keyframes.store.bytes_in_memory(), before / 2);
}

TEST(MapKeyframe, ShowsDepthWithTheCalibrationInForceAsOfItsColoursTime) {
  const auto raw = wall_frame(small_camera(), SE3{}, 0);
  DepthCalibration nearer;
  nearer.camera = small_camera();
  nearer.grid = {2, 2};
  nearer.offset_per_m.assign(4, 0.05);
  Vector6d lag;
  lag << 0, 0.02, 0, 0.01, 0, 0;
  MapKeyframe keyframe({std::make_shared<const history::StoredView>(*raw), 10, nullptr, lag},
                       SE3{});
  const auto expected = [&](const DepthImage& depth) {
    return depth_with_colour(depth, small_camera(), lag)(90, 40);
  };
  EXPECT_NEAR(keyframe.pictures()->depth(90, 40), expected(raw->depth), 2e-4);
  keyframe.see_with(std::make_shared<const DepthCalibration>(nearer));
  EXPECT_NEAR(keyframe.pictures()->depth(90, 40), expected(nearer.apply(raw->depth)), 2e-4);
}

TEST(MapKeyframe, WhatIsTooFarIsNotMeasured) {
  const auto frame = wall_frame(small_camera(), SE3{}, 0, 4);
  EXPECT_EQ(MapKeyframe(*frame, SE3{}, 3).pictures()->depth(3, 4), 0);
  EXPECT_GT(MapKeyframe(*frame, SE3{}, 5).pictures()->depth(3, 4), 3);
}

}  // namespace
}  // namespace sgs::mapper
