// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/depth_segments.h"

#include <gtest/gtest.h>

#include "sgs/alignment/movers/static_score.h"

namespace sgs::alignment {
namespace {

constexpr int kColumns = 30, kRows = 20;

// A wall, and before it somebody upright between columns 9 and 16, whose left half nothing is
// measured of in one row.
std::vector<float> somebody_before_a_wall() {
  std::vector<float> depth(kColumns * kRows, 3.0f);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 9; x <= 16; ++x) depth[static_cast<std::size_t>(y * kColumns + x)] = 1.2f;
  }
  for (std::size_t x = 9; x < 13; ++x) depth[x] = 0;
  return depth;
}

TEST(DepthSegments, NoneReachesAcrossAnEdge) {
  const std::vector<float> depth = somebody_before_a_wall();
  const DepthSegments segments = segment_depth(depth, kColumns);
  std::vector<float> of_segment(static_cast<std::size_t>(segments.count), 0);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) {
      EXPECT_EQ(segments.of[i], DepthSegments::kNone);
      continue;
    }
    ASSERT_NE(segments.of[i], DepthSegments::kNone);
    float& z = of_segment[static_cast<std::size_t>(segments.of[i])];
    if (z == 0) z = depth[i];
    EXPECT_EQ(z, depth[i]) << i;
  }
  for (const DepthSegments::Border& b : segments.borders) {
    EXPECT_LT(b.a, b.b);
    EXPECT_EQ(of_segment[b.a], of_segment[b.b]);
  }
  EXPECT_FALSE(segments.borders.empty());
}

TEST(StaticScore, WhatIsOffTakesItsSurfaceAlongAndNoOther) {
  const std::vector<float> depth = somebody_before_a_wall();
  const DepthSegments segments = segment_depth(depth, kColumns);
  std::vector<float> off(depth.size(), 0);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const std::size_t x = i % kColumns;
    if (depth[i] == 1.2f) off[i] = x < 14 ? 1.0f : -1.0f;  // the right of it is not known
    if (x == 20 && i % 3 == 0) off[i] = 1;                 // noise on the wall
  }
  const std::vector<float> still = score_still(segments, off, {});
  for (std::size_t i = 0; i < depth.size(); ++i) {
    EXPECT_EQ(still[i] < 0.5f, depth[i] == 1.2f) << i;
  }
}

TEST(StaticScore, RemembersWhereNothingIsKnown) {
  const std::vector<float> depth = somebody_before_a_wall();
  const DepthSegments segments = segment_depth(depth, kColumns);
  const std::vector<float> unknown(depth.size(), -1.0f);
  std::vector<float> before(depth.size(), 1.0f);
  for (std::size_t i = 0; i < depth.size(); ++i) before[i] = depth[i] == 1.2f ? 0.1f : 1.0f;
  const std::vector<float> still = score_still(segments, unknown, before);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    EXPECT_EQ(still[i] < 0.5f, depth[i] == 1.2f) << i;
  }
  for (const float s : score_still(segments, unknown, {})) EXPECT_EQ(s, kUnknownStill);
}

TEST(StaticScore, OfWhatIsNotMeasuredNothingIsKnownButWhatWas) {
  const std::vector<float> depth = somebody_before_a_wall();
  const DepthSegments segments = segment_depth(depth, kColumns);
  std::vector<float> off(depth.size(), -1.0f), before(depth.size(), kUnknownStill);
  off[10] = 1;        // something is before what stood there
  before[11] = 0.1f;  // it moved when it was measured last
  const std::vector<float> still = score_still(segments, off, before);
  EXPECT_EQ(still[10], 0);
  EXPECT_EQ(still[11], 0.1f);
  EXPECT_EQ(still[12], kUnknownStill);
  for (std::size_t i = 13; i < depth.size(); ++i) ASSERT_EQ(still[i], kUnknownStill) << i;
}

}  // namespace
}  // namespace sgs::alignment
