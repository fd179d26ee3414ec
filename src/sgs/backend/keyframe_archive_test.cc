// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/keyframe_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/backend/test_room.h"

namespace sgs::backend {
namespace {

std::vector<std::int64_t> frames_of(const KeyframeArchive& archive) {
  std::vector<std::int64_t> out;
  for (const Keyframe& k : archive.keyframes()) out.push_back(k.frame);
  return out;
}

/// Feeds views of the room, as many metres apart; returns where the frames are.
history::Path walk(KeyframeArchive& archive, int first, int frames, double step_m,
                   history::Path path = {}, bool with_depth = true) {
  const auto seen = TestRoom().view(0);
  for (int k = first; k < first + frames; ++k) {
    const auto frame = std::make_shared<RgbdFrame>(*seen);
    frame->index = k;
    frame->timestamp_s = k / 30.0;
    if (!with_depth) frame->depth.fill(0);
    path.append({k, frame->timestamp_s, SE3(Eigen::Matrix3d::Identity(), {step_m * k, 0, 0})});
    archive.add(frame, path);
  }
  return path;
}

TEST(KeyframeArchive, KeepsAViewWhenItHasMoved) {
  KeyframeArchive archive({});
  const history::Path path = walk(archive, 0, 20, 0.02);
  ASSERT_GE(archive.keyframes().size(), 2u);
  for (std::size_t i = 1; i < archive.keyframes().size(); ++i) {
    const Keyframe& before = archive.keyframes()[i - 1];
    const Keyframe& keyframe = archive.keyframes()[i];
    EXPECT_GT(view_distance(before, path.at(before.frame).inverse() * path.at(keyframe.frame)),
              ArchiveConfig{}.view_distance);
    EXPECT_NEAR(keyframe.velocity[3], 0.02 * 30, 1e-9);
    EXPECT_FALSE(keyframe.pixels.empty());
  }
}

TEST(KeyframeArchive, AStandingCameraGivesOneKeyframe) {
  KeyframeArchive archive({});
  walk(archive, 0, 20, 0);
  EXPECT_EQ(archive.keyframes().size(), 1u);
}

TEST(KeyframeArchive, WhatLiesBesideAGapTellsNoVelocity) {
  KeyframeArchive archive({});
  const history::Path before = walk(archive, 0, 2, 0.2);
  archive.note_gap();
  walk(archive, 2, 2, 0.2, before);
  EXPECT_THAT(frames_of(archive), testing::IsEmpty());
  KeyframeArchive late({});
  walk(late, 20, 1, 0.2, walk(late, 0, 2, 0.2));  // 0.6 s later
  EXPECT_THAT(frames_of(late), testing::IsEmpty());
}

TEST(KeyframeArchive, KeepsTheFirstOnes) {
  KeyframeArchive archive({});
  walk(archive, 0, 230, 0.3);
  EXPECT_EQ(archive.keyframes().size(), 200u);
  EXPECT_EQ(frames_of(archive).front(), 1);
}

TEST(KeyframeArchive, AFrameWithoutDepthIsNone) {
  KeyframeArchive archive({});
  walk(archive, 0, 5, 0.3, {}, false);
  EXPECT_THAT(frames_of(archive), testing::IsEmpty());
}

}  // namespace
}  // namespace sgs::backend
