// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/sparse_steps.h"

#include <gmock/gmock.h>

namespace sgs::mapper {
namespace {

using ::testing::ElementsAre;

TEST(SparseSteps, LeavesNothingOutByDefault) {
  SparseSteps sparse{ScheduleConfig{}};
  const std::vector<std::uint32_t> steps(5, 1000);
  EXPECT_TRUE(sparse.frozen(steps, 1).empty());
  EXPECT_TRUE(sparse.tiles(0, 0).empty());
  EXPECT_EQ(sparse.tile_loss(0, 0), nullptr);
}

TEST(SparseSteps, FreezesOldGaussiansInAllButEveryNthStep) {
  ScheduleConfig config;
  config.freeze_after_steps = 10;
  config.freeze_interval = 3;
  SparseSteps sparse(config);
  const std::vector<std::uint32_t> steps = {9, 10, 400};
  EXPECT_TRUE(sparse.frozen(steps, 0).empty());
  EXPECT_THAT(sparse.frozen(steps, 1), ElementsAre(0, 1, 1));
  EXPECT_THAT(sparse.frozen(steps, 2), ElementsAre(0, 1, 1));
  EXPECT_TRUE(sparse.frozen(steps, 3).empty());
}

TEST(SparseSteps, EverySecondVisitLeavesOutGoodTiles) {
  ScheduleConfig config;
  config.tile_loss_floor = 0.5;
  SparseSteps sparse(config);
  for (int round = 0; round < 2; ++round) {
    EXPECT_TRUE(sparse.tiles(3, 1).empty());
    ASSERT_NE(sparse.tile_loss(3, 1), nullptr);
    *sparse.tile_loss(3, 1) = {1, 0.1f, 2, 0.9f};
    EXPECT_TRUE(sparse.tiles(0, 0).empty());  // other keyframes and levels count on their own
    EXPECT_TRUE(sparse.tiles(3, 0).empty());
    EXPECT_THAT(sparse.tiles(3, 1), ElementsAre(1, 0, 1, 1));
    EXPECT_EQ(sparse.tile_loss(3, 1), nullptr);
  }
}

}  // namespace
}  // namespace sgs::mapper
