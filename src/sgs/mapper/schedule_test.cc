// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace sgs::mapper {
namespace {

TEST(Schedule, VisitsANewKeyframeFirst) {
  Schedule schedule(1, true);
  schedule.add_keyframe(0);
  EXPECT_EQ(schedule.next(), 0u);
  schedule.add_keyframe(1);
  EXPECT_EQ(schedule.next(), 1u);
}

TEST(Schedule, VisitsEveryKeyframeOncePerRound) {
  Schedule schedule(7, true);
  for (std::size_t i = 0; i < 9; ++i) {
    schedule.add_keyframe(i);
    schedule.next();
  }
  std::vector<std::size_t> first_order;
  for (int round = 0; round < 5; ++round) {
    std::vector<std::size_t> order;
    for (int i = 0; i < 9; ++i) order.push_back(schedule.next());
    EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), 9u);
    if (round == 0) first_order = order;
    if (round == 4) {
      EXPECT_NE(order, first_order);
    }
  }
}

TEST(Schedule, DependsOnNothingButTheSeed) {
  const auto draw = [](std::uint64_t seed) {
    Schedule schedule(seed, true);
    for (std::size_t i = 0; i < 9; ++i) schedule.add_keyframe(i);
    std::vector<std::size_t> drawn;
    for (int i = 0; i < 40; ++i) drawn.push_back(schedule.next());
    return drawn;
  };
  EXPECT_EQ(draw(3), draw(3));
  EXPECT_NE(draw(3), draw(4));
}

TEST(Random, IsUniform) {
  Random random(5);
  std::vector<int> histogram(10);
  for (int i = 0; i < 10000; ++i) ++histogram[random.below(10)];
  for (const int count : histogram) EXPECT_NEAR(count, 1000, 150);
}

}  // namespace
}  // namespace sgs::mapper
