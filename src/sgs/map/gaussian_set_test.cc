// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/gaussian_set.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::map {
namespace {

GaussianSet make_set(const std::vector<bool>& members) {
  GaussianSet set;
  set.clear(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (members[i]) set.insert(i);
  }
  return set;
}

std::vector<bool> random_members(std::size_t count, double share, std::mt19937& engine) {
  std::bernoulli_distribution is_member(share);
  std::vector<bool> members(count);
  for (std::size_t i = 0; i < count; ++i) members[i] = is_member(engine);
  return members;
}

TEST(GaussianSet, KnowsNothingOfLaterGaussians) {
  GaussianSet set;
  EXPECT_EQ(set.maybe(0), ~std::uint64_t{0});
  set.clear(70);
  set.insert(3);
  set.insert(66);
  EXPECT_EQ(set.count(), 2u);
  EXPECT_TRUE(set.contains(66));
  EXPECT_FALSE(set.contains(67));
  EXPECT_EQ(set.maybe(0), std::uint64_t{1} << 3);
  EXPECT_EQ(set.maybe(1), (std::uint64_t{1} << 2) | ~std::uint64_t{63});
  EXPECT_EQ(set.maybe(2), ~std::uint64_t{0});
}

TEST(GaussianSet, FollowsRemovals) {
  std::mt19937 engine(1);
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 128u, 1000u}) {
    for (const double share : {0.0, 0.02, 0.5, 1.0}) {
      const std::vector<bool> members = random_members(count, 0.4, engine);
      // The map has grown since: the removal is about more Gaussians than the set.
      const std::vector<bool> removed = random_members(count + 77, share, engine);
      std::vector<bool> expected;
      for (std::size_t i = 0; i < count; ++i) {
        if (!removed[i]) expected.push_back(members[i]);
      }
      GaussianSet set = make_set(members);
      set.follow_removal(make_set(removed));
      ASSERT_EQ(set.size(), expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(set.contains(i), expected[i]);
      const auto in_it = std::count(expected.begin(), expected.end(), true);
      EXPECT_EQ(set.count(), static_cast<std::size_t>(in_it));
    }
  }
}

TEST(GaussianSet, RefusesTheRemovalsOfASmallerMap) {
  GaussianSet set = make_set(std::vector<bool>(10)), few = make_set(std::vector<bool>(9));
  EXPECT_THROW(set.follow_removal(few), ContractViolation);
}

}  // namespace
}  // namespace sgs::map
