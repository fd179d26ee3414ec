// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/moving_blocks.h"

#include <gtest/gtest.h>

namespace sgs::registration {
namespace {

constexpr int kWidth = 320, kHeight = 240, kStep_px = 8;

template <class Flow>
MovingBlocks judge(const Flow& flow_px) {
  FlowVotes votes(kWidth, kHeight);
  for (int v = 0; v < kHeight; v += kStep_px) {
    for (int u = 0; u < kWidth; u += kStep_px) {
      const float px = flow_px(u, v);
      if (px >= 0) votes.add(u, v, px);
    }
  }
  return votes.judge();
}

TEST(MovingBlocks, NoneByDefault) {
  EXPECT_FALSE(MovingBlocks().any());
  EXPECT_FALSE(MovingBlocks().at(3, 4));
}

TEST(FlowVotes, WhatIsOffFartherThanTheRestMoves) {
  const auto moving = judge([](int u, int) { return u < 128 ? 8.f : 0.4f; });
  EXPECT_TRUE(moving.at(10, 100));
  EXPECT_FALSE(moving.at(200, 100));
}

TEST(FlowVotes, MostOfThePictureMayMove) {
  const auto moving = judge([](int u, int) { return u < 192 ? 8.f : 0.4f; });
  EXPECT_TRUE(moving.at(10, 100));
  EXPECT_FALSE(moving.at(250, 100));
}

TEST(FlowVotes, APoseThatIsOffMovesNothing) {
  EXPECT_FALSE(judge([](int u, int v) { return 6.f + 0.01f * static_cast<float>(u + v); }).any());
  EXPECT_FALSE(judge([](int, int) { return 0.3f; }).any());
}

TEST(FlowVotes, PlainPartsAreAsTheirNeighbours) {
  const auto moving = judge([](int u, int v) {
    const bool plain = u >= 64 && u < 96 && v >= 64 && v < 96;
    return plain ? -1.f : u < 128 ? 8.f : 0.4f;
  });
  EXPECT_TRUE(moving.at(80, 80));
}

TEST(FlowVotes, TooFewBlocksTellNothing) {
  EXPECT_FALSE(judge([](int u, int v) { return u < 64 && v < 64 ? 8.f : -1.f; }).any());
}

}  // namespace
}  // namespace sgs::registration
