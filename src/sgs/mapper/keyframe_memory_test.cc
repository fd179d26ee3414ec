// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_memory.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstring>
#include <memory>

#include "sgs/mapper/test_wall_scene.h"

namespace sgs::mapper {
namespace {

/// Keyframes that come one by one, with views that are visited.
struct Session {
  explicit Session(std::size_t budget_bytes) : memory(budget_bytes) {}
  void add() {
    const auto index = static_cast<std::int64_t>(keyframes.size());
    const auto T = translated(0.01 * static_cast<double>(index), 0, 0);
    keyframes.emplace_back(*wall_frame(small_camera(), T, index), T, 10);
    memory.make_room(keyframes, views);
    views.get(keyframes.back(), keyframes.size() - 1, 1);
  }

  std::unique_ptr<render::Rasterizer> rasterizer = render::make_cpu_rasterizer(nullptr);
  TrainingViewCache views{*rasterizer, 2};
  KeyframeMemory memory;
  std::vector<MapKeyframe> keyframes;
};

TEST(KeyframeMemory, WhatIsParkedComesBackAsItWas) {
  Session tight(1), wide(std::size_t{1} << 40);
  for (int i = 0; i < 100; ++i) {
    tight.add();
    wide.add();
  }
  EXPECT_EQ(wide.views.first_half_kept(), 0u);
  EXPECT_GT(tight.views.first_half_kept(), 0u);
  EXPECT_LE(tight.views.first_half_kept(), 100u - 16u);
  for (std::size_t i = 0; i < 100; ++i) {
    const auto a = tight.keyframes[i].pictures(), b = wide.keyframes[i].pictures();
    // Those in memory are handed out, those on disk are read each time.
    EXPECT_EQ(wide.keyframes[i].pictures(), b);
    EXPECT_EQ(tight.keyframes[i].pictures() == a, i >= 100 - 16) << i;
    EXPECT_EQ(std::memcmp(a->color.data(), b->color.data(), a->color.size() * sizeof(Rgb8)), 0);
    EXPECT_EQ(std::memcmp(a->depth.data(), b->depth.data(), a->depth.size() * 2), 0);
    EXPECT_EQ(a->depth_m(3, 4), b->depth_m(3, 4));
    EXPECT_TRUE(tight.views.get(tight.keyframes[i], i, 0));
    EXPECT_TRUE(tight.views.get(tight.keyframes[i], i, 1));
  }
}

TEST(KeyframeMemory, WhatIsCulledMakesRoom) {
  Session tight(1), wide(std::size_t{1} << 40);
  for (std::size_t i = 0; i < 100; ++i) {
    for (Session* session : {&tight, &wide}) {
      session->add();
      if (i < 40 || i % 2 == 0) continue;
      session->memory.cull(session->keyframes[i - 25]);  // some are parked, some are not
      session->views.forget(i - 25);
    }
  }
  for (std::size_t i = 0; i < 100; ++i) {
    if (tight.keyframes[i].culled()) continue;
    const auto a = tight.keyframes[i].pictures(), b = wide.keyframes[i].pictures();
    EXPECT_EQ(std::memcmp(a->color.data(), b->color.data(), a->color.size() * sizeof(Rgb8)), 0);
    EXPECT_EQ(std::memcmp(a->depth.data(), b->depth.data(), a->depth.size() * 2), 0);
    EXPECT_TRUE(tight.views.get(tight.keyframes[i], i, 1));
  }
}

/// Everything is nearer by 0.05 / m.
std::shared_ptr<const DepthChange> nearer() {
  DepthCalibration c;
  c.camera = small_camera();
  c.grid = {2, 2};
  c.offset_per_m.assign(4, 0.05);
  return std::make_shared<DepthChange>(DepthCalibration{}, c);
}

TEST(MapKeyframe, PicturesThatSomebodyHoldsStayAsTheyWere) {
  MapKeyframe keyframe(*wall_frame(small_camera(), SE3{}, 0), SE3{}, 10);
  auto held = keyframe.pictures();
  const float before = held->depth_m(3, 4);
  ASSERT_GT(before, 0);
  keyframe.change_pictures(nearer());
  EXPECT_EQ(held->depth_m(3, 4), before);
  const float once = keyframe.pictures()->depth_m(3, 4);
  EXPECT_LT(once, before);
  // Nobody holds them now: changed where they are.
  const KeyframePictures* const place = keyframe.pictures().get();
  keyframe.change_pictures(nearer());
  EXPECT_EQ(keyframe.pictures().get(), place);
  EXPECT_LT(keyframe.pictures()->depth_m(3, 4), once);
}

TEST(MapKeyframe, ACulledOneKeepsNoInformation) {
  MapKeyframe keyframe(*wall_frame(small_camera(), SE3{}, 0), SE3{}, 10);
  keyframe.pose_information = std::make_shared<Matrix6d>(Matrix6d::Identity());
  keyframe.cull(nullptr);
  EXPECT_EQ(keyframe.pose_information, nullptr);
}

TEST(KeyframeMemory, WithoutADiskMoreMemoryIsUsed) {
  ASSERT_EQ(setenv("TMPDIR", "/no/such/folder", 1), 0);
  Session tight(1);
  for (int i = 0; i < 100; ++i) tight.add();
  ASSERT_EQ(unsetenv("TMPDIR"), 0);
  EXPECT_EQ(tight.views.first_half_kept(), 0u);
  EXPECT_EQ(tight.keyframes[0].pictures(), tight.keyframes[0].pictures());
}

}  // namespace
}  // namespace sgs::mapper
