// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/training_frames.h"

#include <gtest/gtest.h>

namespace sgs::refine {
namespace {

constexpr int kSide = 32;

/// Stripes `period` pixels wide: the wider, the less sharp.
RgbdFrame striped(std::int64_t index, int period) {
  RgbdFrame frame;
  frame.index = index;
  frame.timestamp_s = 0.1 * static_cast<double>(index);
  frame.camera = {kSide, kSide, 30, 30, 15.5, 15.5};
  frame.color = ColorImage(kSide, kSide);
  frame.depth = DepthImage(kSide, kSide, 1.0f);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const std::uint8_t v = (x / period) % 2 == 0 ? 200 : 50;
      frame.color(x, y) = {v, v, v};
    }
  }
  return frame;
}

std::size_t bytes_of(int frames) { return static_cast<std::size_t>(frames) * kSide * kSide * 5; }

TEST(Sharpness, FallsWithBlurAndIsZeroWithoutEdges) {
  EXPECT_GT(sharpness(striped(0, 1).color), sharpness(striped(0, 4).color));
  EXPECT_EQ(sharpness(striped(0, kSide).color), 0.0);
  EXPECT_EQ(sharpness(ColorImage(2, 2)), 0.0);
}

TEST(FrameSelection, WithinItsMemoryEveryFrameStays) {
  FrameSelection selection(striped(0, 1).camera, 6, bytes_of(6));
  for (int i = 0; i < 6; ++i) selection.offer(striped(i, 1), SE3());
  EXPECT_EQ(selection.finish().size(), 6u);
}

TEST(FrameSelection, BeyondItTheSharpestOfEachGroupStays) {
  FrameSelection selection(striped(0, 1).camera, 6, bytes_of(2));
  ASSERT_EQ(selection.group(), 3);
  const int periods[] = {4, 1, 4, 4, 4, 1};
  for (int i = 0; i < 6; ++i) selection.offer(striped(i, periods[i]), SE3());
  const auto frames = selection.finish();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].keyframe.frame_index(), 1);
  EXPECT_EQ(frames[1].keyframe.frame_index(), 5);
}

TEST(FrameSelection, BlurredFramesWeighLess) {
  FrameSelection selection(striped(0, 1).camera, 5, bytes_of(5));
  for (int i = 0; i < 5; ++i) selection.offer(striped(i, i == 2 ? 8 : 2), SE3());
  const auto frames = selection.finish();
  EXPECT_LT(frames[2].weight, frames[1].weight);
  EXPECT_GT(frames[2].weight, 0.0);
}

}  // namespace
}  // namespace sgs::refine
