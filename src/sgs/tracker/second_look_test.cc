// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/second_look.h"

#include <gtest/gtest.h>

#include <functional>

#include "sgs/alignment/test_textured_wall.h"

namespace sgs::tracker {
namespace {

constexpr int kFilmed = 20;

// Somebody walks at the right edge from frame 8 on, as was found out.
std::shared_ptr<const PixelMask> walker(int index) {
  if (index < 8) return nullptr;
  const PinholeCamera& camera = alignment::kWallCamera;
  PixelMask still(camera.width, camera.height, std::uint8_t{1});
  for (int v = 0; v < camera.height; ++v) {
    std::fill(still.row(v) + 260, still.row(v) + camera.width, std::uint8_t{0});
  }
  return std::make_shared<const PixelMask>(std::move(still));
}

// The wall along wall_pose(), tracked to where `tracked` says; the last thing that is found.
std::optional<PoseCorrection> look(const std::function<SE3(int)>& tracked, bool moves = true,
                                   std::optional<int> forgets_at = {}) {
  SecondLook look{SecondLookConfig{TrackerConfig{}}};
  history::Path path;
  std::optional<PoseCorrection> found;
  for (int i = 0; i < kFilmed; ++i) {
    auto frame = std::make_shared<RgbdFrame>(alignment::see_wall(alignment::wall_pose(i), i));
    path.append({i, frame->timestamp_s, tracked(i)});
    TrackResult result;
    if (moves) result.still = walker(i);
    if (forgets_at == i) look.forget();
    look.see(frame, result);
    if (auto correction = look.look_back(path)) found = std::move(correction);
  }
  return found;
}

// The camera goes along with somebody for a few frames, and jumps back.
SE3 dragged(int index) {
  SE3 T = alignment::wall_pose(index);
  if (index >= 5 && index < 10) T.t.x() += 0.012 * (index - 4);
  return T;
}

TEST(SecondLook, ACameraThatWasDraggedAlongIsPutBack) {
  const auto correction = look(dragged);
  ASSERT_TRUE(correction);
  ASSERT_GE(correction->poses().size(), 15u);
  EXPECT_GT(correction->largest_translation_m(), 0.05);
  for (const MovedPose& p : correction->poses()) {
    const int index = static_cast<int>(std::lround(p.timestamp_s * 30));
    EXPECT_LT((p.after.t - alignment::wall_pose(index).t).norm(), 0.004) << index;
    EXPECT_LT((p.before.t - dragged(index).t).norm(), 1e-12);
  }
}

TEST(SecondLook, WhatWasTrackedWellStays) { EXPECT_FALSE(look(alignment::wall_pose)); }

TEST(SecondLook, NothingIsLookedAtWhereNothingMoves) { EXPECT_FALSE(look(dragged, false)); }

// A path that differs everywhere and jumps nowhere is not explained by somebody who walked off.
TEST(SecondLook, AnotherPathWithoutAReasonIsNotBelieved) {
  EXPECT_FALSE(look([](int index) {
    SE3 T = alignment::wall_pose(index);
    T.t.x() += 0.0004 * index * index;
    return T;
  }));
}

TEST(SecondLook, NothingIsKnownOfTheTimeBeforeALoss) { EXPECT_FALSE(look(dragged, true, 10)); }

}  // namespace
}  // namespace sgs::tracker
