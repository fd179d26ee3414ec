// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/mean_bounds.h"

#include <gtest/gtest.h>

#include <limits>

#include "sgs/core/error.h"

namespace sgs::map {
namespace {

Gaussian at(float x, float y, float z) {
  Gaussian g{};
  g.mean[0] = x;
  g.mean[1] = y;
  g.mean[2] = z;
  return g;
}

TEST(MeanBounds, HoldsEveryMeanOfItsBlock) {
  std::vector<Gaussian> gaussians;
  for (int i = 0; i < 100; ++i) gaussians.push_back(at(static_cast<float>(i), -1, 2));
  MeanBounds bounds;
  bounds.assign(gaussians, gaussians);
  ASSERT_EQ(bounds.boxes().size(), 2u);
  EXPECT_EQ(bounds.boxes()[0].low[0], 0);
  EXPECT_EQ(bounds.boxes()[0].high[0], 63);
  EXPECT_EQ(bounds.boxes()[1].low[0], 64);
  EXPECT_EQ(bounds.boxes()[1].high[0], 99);
  EXPECT_EQ(bounds.boxes()[1].low[1], -1);
  EXPECT_EQ(bounds.boxes()[1].high[2], 2);

  gaussians.push_back(at(-7, 0, 0));
  bounds.append(gaussians);
  EXPECT_EQ(bounds.size(), 101u);
  EXPECT_EQ(bounds.boxes()[1].low[0], -7);
  bounds.widen(3, at(80, 0, 9));
  EXPECT_EQ(bounds.boxes()[0].high[0], 80);
  EXPECT_EQ(bounds.boxes()[0].high[2], 9);
}

TEST(MeanBounds, TakesInBothArraysAndForgetsWhatHasGone) {
  const std::vector<Gaussian> first(70, at(1, 1, 1)), second(70, at(2, 0, 1));
  MeanBounds bounds;
  bounds.assign(first, second);
  EXPECT_EQ(bounds.boxes()[1].low[1], 0);
  EXPECT_EQ(bounds.boxes()[1].high[0], 2);
  const std::vector<Gaussian> fewer(3, at(5, 5, 5));
  EXPECT_THROW(bounds.append(fewer), ContractViolation);
  bounds.assign(fewer, fewer);
  ASSERT_EQ(bounds.boxes().size(), 1u);
  EXPECT_EQ(bounds.boxes()[0].low[0], 5);
}

TEST(MeanBounds, NotANumberChangesNothing) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Gaussian> gaussians = {at(1, 2, 3), at(kNan, kNan, kNan)};
  MeanBounds bounds;
  bounds.assign(gaussians, gaussians);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(bounds.boxes()[0].low[k], static_cast<float>(k + 1));
    EXPECT_EQ(bounds.boxes()[0].high[k], static_cast<float>(k + 1));
  }
}

}  // namespace
}  // namespace sgs::map
