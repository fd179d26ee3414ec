// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/in_the_air.h"

#include <gtest/gtest.h>

#include "sgs/mapjoin/test_walls.h"

namespace sgs::mapjoin {
namespace {

TEST(InTheAir, OnlyWhatTheOtherMapSawThroughGoes) {
  Part both =
      side_by_side(walk_along_wall("first", 0, 3, SE3{}), walk_along_wall("second", 0, 3, SE3{}));
  auto& gaussians = both.gaussians.splats.gaussians;
  const std::size_t all = gaussians.size();
  EXPECT_EQ(drop_in_the_air(both, 1), 0u);
  gaussians[1].mean[2] = 0.7f;        // of the first, halfway to the wall
  gaussians[all - 1].mean[2] = 1.6f;  // of the second, behind it
  EXPECT_EQ(drop_in_the_air(both, 1), 1u);
  EXPECT_EQ(gaussians.size(), all - 1);
  EXPECT_EQ(both.gaussians.born_s[1], 2);
}

TEST(InTheAir, WhatOnlyItsOwnMapSeesStays) {
  Part both =
      side_by_side(walk_along_wall("first", 0, 3, SE3{}), walk_along_wall("second", 30, 3, SE3{}));
  both.gaussians.splats.gaussians[1].mean[2] = 0.7f;
  EXPECT_EQ(drop_in_the_air(both, 1), 0u);
}

}  // namespace
}  // namespace sgs::mapjoin
