// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/movers.h"

#include <gtest/gtest.h>

#include "sgs/core/error.h"

namespace sgs {
namespace {

std::shared_ptr<const RgbdFrame> frame_with_rim() {
  auto frame = std::make_shared<RgbdFrame>();
  frame->camera = {4, 3, 4, 4, 1.5, 1};
  frame->color = ColorImage(4, 3, {10, 20, 30});
  frame->depth = DepthImage(4, 3, 2.0f);
  PixelMask seen(4, 3, std::uint8_t{1});
  seen(0, 0) = 0;
  frame->seen = std::make_shared<const PixelMask>(seen);
  return frame;
}

std::shared_ptr<const PixelMask> person_at(int u, int v) {
  PixelMask still(4, 3, std::uint8_t{255});
  still(u, v) = 0;
  return std::make_shared<const PixelMask>(std::move(still));
}

TEST(WithoutMovers, HasNeitherDepthNorSightOfThem) {
  const auto frame = frame_with_rim();
  const auto scene = without_movers(frame, person_at(2, 1));
  EXPECT_EQ(scene->depth(2, 1), 0);
  EXPECT_EQ(scene->depth(1, 1), 2);
  EXPECT_FALSE(scene->sees(2, 1));
  EXPECT_FALSE(scene->sees(0, 0));
  EXPECT_TRUE(scene->sees(1, 1));
  EXPECT_EQ((*scene->still)(0, 0), 255) << "what the lens does not show does not move";
  EXPECT_EQ(scene->delivered, frame);
  EXPECT_TRUE(scene->color(2, 1) == frame->color(2, 1));
  EXPECT_EQ(frame->depth(2, 1), 2);
}

TEST(WithoutMovers, IsTheFrameWhereNothingMoves) {
  const auto frame = frame_with_rim();
  EXPECT_EQ(without_movers(frame, nullptr), frame);
}

TEST(WithoutMovers, NeedsAMaskOfItsSize) {
  EXPECT_THROW(
      without_movers(frame_with_rim(), std::make_shared<const PixelMask>(3, 3, std::uint8_t{1})),
      ContractViolation);
}

TEST(InBoth, ANullMaskHasNoZeros) {
  const auto a = person_at(1, 1), b = person_at(3, 0);
  EXPECT_EQ(in_both(a, nullptr), a);
  EXPECT_EQ(in_both(nullptr, b), b);
  EXPECT_EQ(in_both(nullptr, nullptr), nullptr);
  const auto both = in_both(a, b);
  EXPECT_EQ((*both)(1, 1), 0);
  EXPECT_EQ((*both)(3, 0), 0);
  EXPECT_NE((*both)(0, 0), 0);
}

TEST(MoverBlocks, ComeBackWhole) {
  PixelMask still(20, 17, std::uint8_t{1});  // three by three squares
  still(9, 3) = still(19, 16) = 0;
  const std::string blocks = mover_blocks(still);
  EXPECT_EQ(blocks.size(), 2u);
  const auto back = still_from_blocks(blocks, 20, 17);
  ASSERT_TRUE(back);
  for (int v = 0; v < 17; ++v) {
    for (int u = 0; u < 20; ++u) {
      const bool moves = (u / 8 == 1 && v / 8 == 0) || (u / 8 == 2 && v / 8 == 2);
      EXPECT_EQ((*back)(u, v) == 0, moves) << u << " " << v;
    }
  }
  EXPECT_FALSE(still_from_blocks(blocks, 640, 480));
}

}  // namespace
}  // namespace sgs
