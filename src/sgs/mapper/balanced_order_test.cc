// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/balanced_order.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace sgs::mapper {
namespace {

/// The first `steps` views of an order of these weights.
std::vector<std::size_t> drawn(const std::vector<double>& weights, std::uint64_t seed, int steps) {
  SplitMix64 random(seed);
  BalancedOrder order;
  for (const double weight : weights) order.add(weight, random);
  std::vector<std::size_t> all(weights.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<std::size_t> views;
  for (int i = 0; i < steps; ++i) views.push_back(order.next(all, random));
  return views;
}

TEST(BalancedOrder, VisitsInProportionToTheWeights) {
  int visits[3] = {};
  for (const std::size_t view : drawn({1, 2, 1}, 7, 400)) ++visits[view];
  EXPECT_NEAR(visits[0], 100, 2);
  EXPECT_NEAR(visits[1], 200, 2);
}

TEST(BalancedOrder, IsShuffledAndRepeatable) {
  const std::vector<double> equal(8, 1.0);
  const auto first = drawn(equal, 3, 64);
  EXPECT_EQ(first, drawn(equal, 3, 64));
  EXPECT_NE(first, drawn(equal, 4, 64));
  EXPECT_NE(std::vector(first.begin(), first.begin() + 8),
            std::vector(first.begin() + 8, first.begin() + 16));
}

TEST(BalancedOrder, OnlyActiveViewsCome) {
  SplitMix64 random(1);
  BalancedOrder order;
  for (int i = 0; i < 4; ++i) order.add(1, random);
  const std::vector<std::size_t> active = {1, 3};
  for (int i = 0; i < 20; ++i) EXPECT_EQ(order.next(active, random) % 2, 1u);
  EXPECT_TRUE(order.consistent());
}

}  // namespace
}  // namespace sgs::mapper
