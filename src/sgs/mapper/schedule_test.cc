// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

namespace sgs::mapper {
namespace {

TEST(Schedule, VisitsANewKeyframeFirst) {
  Schedule schedule(1, VisitOrder::kBalanced, 0.5);
  schedule.add_keyframe(0);
  EXPECT_EQ(schedule.next(), 0u);
  schedule.add_keyframe(1);
  EXPECT_EQ(schedule.next(), 1u);
}

TEST(Schedule, VisitsEveryKeyframeOncePerRound) {
  Schedule schedule(7, VisitOrder::kRounds, 0);
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
  const auto draw = [](std::uint64_t seed, VisitOrder order) {
    Schedule schedule(seed, order, 0.5);
    for (std::size_t i = 0; i < 9; ++i) schedule.add_keyframe(i);
    std::vector<std::size_t> drawn;
    for (int i = 0; i < 40; ++i) drawn.push_back(schedule.next());
    return drawn;
  };
  for (const VisitOrder order : {VisitOrder::kBalanced, VisitOrder::kRounds, VisitOrder::kRandom}) {
    EXPECT_EQ(draw(3, order), draw(3, order));
    EXPECT_NE(draw(3, order), draw(4, order));
  }
}

TEST(Schedule, BalancedOrderFavoursTheLeastVisited) {
  // Forty keyframes, twelve steps each. In rounds the last eight would have 12 ln(40 / k), on
  // average 1.3, visits beside their first, the one in the middle 8.
  const auto visits = [](double bias) {
    Schedule schedule(5, VisitOrder::kBalanced, bias);
    std::vector<int> count(40);
    for (std::size_t k = 0; k < count.size(); ++k) {
      schedule.add_keyframe(k);
      for (int i = 0; i < 12; ++i) ++count[schedule.next()];
    }
    return std::pair(count.front(), std::accumulate(count.end() - 8, count.end(), 0) / 8.0);
  };
  const auto [even_first, even_last] = visits(0);
  const auto [biased_first, biased_last] = visits(1);
  EXPECT_NEAR(even_last, 1 + 1.3, 0.6);
  EXPECT_GT(biased_last, 1.2 * even_last);
  EXPECT_LT(biased_first, even_first);
  EXPECT_GT(biased_first, biased_last) << "old keyframes are not forgotten";
}

TEST(Schedule, BalancedOrderSpreadsVisitsOverTime) {
  Schedule schedule(5, VisitOrder::kBalanced, 0.5);
  constexpr int kKeyframes = 20;
  for (std::size_t k = 0; k < kKeyframes; ++k) schedule.add_keyframe(k);
  std::vector<int> last_visit(kKeyframes, 0);
  int longest = 0;
  for (int step = 0; step < 400; ++step) {
    int& last = last_visit[schedule.next()];
    longest = std::max(longest, step - last);
    last = step;
  }
  EXPECT_LE(longest, 2 * kKeyframes) << "twice a round, because of the jitter";
}

TEST(Schedule, WhatIsCulledComesNoMore) {
  for (const VisitOrder order : {VisitOrder::kBalanced, VisitOrder::kRounds, VisitOrder::kRandom}) {
    Schedule schedule(5, order, 0.5);
    for (std::size_t k = 0; k < 9; ++k) schedule.add_keyframe(k);
    schedule.cull(7);  // before its first visit
    for (int i = 0; i < 12; ++i) EXPECT_NE(schedule.next(), 7u);
    schedule.cull(0);
    schedule.cull(4);
    std::set<std::size_t> visited;
    for (int i = 0; i < 100; ++i) visited.insert(schedule.next());
    EXPECT_EQ(visited, (std::set<std::size_t>{1, 2, 3, 5, 6, 8}));
    schedule.add_keyframe(9);
    EXPECT_EQ(schedule.next(), 9u);
    EXPECT_TRUE(schedule.consistent());
  }
}

TEST(SplitMix64, IsUniform) {
  SplitMix64 random(5);
  std::vector<int> histogram(10);
  for (int i = 0; i < 10000; ++i) ++histogram[random.below(10)];
  for (const int count : histogram) EXPECT_NEAR(count, 1000, 150);
}

}  // namespace
}  // namespace sgs::mapper
