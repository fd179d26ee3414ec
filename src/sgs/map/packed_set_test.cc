// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/packed_set.h"

#include <gmock/gmock.h>

#include <random>

#include "sgs/core/archive.h"

namespace sgs::map {
namespace {

GaussianSet random_set(std::size_t count, double share, std::mt19937& engine) {
  // Whole words are empty where the share is small, as in a large map.
  std::bernoulli_distribution word_is_seen(share < 0.5 ? 0.2 : 1.0), is_member(share);
  GaussianSet set;
  set.clear(count);
  bool seen = false;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % GaussianSet::kWord == 0) seen = word_is_seen(engine);
    if (seen && is_member(engine)) set.insert(i);
  }
  return set;
}

void expect_same(const GaussianSet& a, const GaussianSet& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.contains(i), b.contains(i)) << i;
}

constexpr std::size_t kCounts[] = {0, 1, 63, 64, 65, 128, 1000, 4096, 4097, 20000};

TEST(PackedSet, IsTheSameSetAgain) {
  std::mt19937 engine(1);
  for (const std::size_t count : kCounts) {
    for (const double share : {0.0, 0.3, 1.0}) {
      const GaussianSet set = random_set(count, share, engine);
      const PackedSet packed(set);
      GaussianSet again;
      packed.unpack(again);
      expect_same(set, again);
    }
  }
}

TEST(PackedSet, FollowsRemovalsAsTheSetDoes) {
  std::mt19937 engine(2);
  for (const std::size_t count : kCounts) {
    for (const double share : {0.0, 0.02, 0.5, 1.0}) {
      GaussianSet set = random_set(count, 0.3, engine);
      // The map has grown since: the removal is about more Gaussians than the set.
      const GaussianSet removed = random_set(count + 77, share, engine);
      PackedSet packed(set);
      packed.follow_removal(Removal(removed));
      set.follow_removal(removed);
      GaussianSet again;
      packed.unpack(again);
      expect_same(set, again);
    }
  }
}

TEST(PackedSet, ACornerOfALargeMapIsSmall) {
  GaussianSet set;
  set.clear(1'000'000);
  for (std::size_t i = 400'000; i < 420'000; ++i) set.insert(i);
  EXPECT_LT(PackedSet(set).bytes(), 5000u);
}

TEST(PackedSet, IsArchived) {
  std::mt19937 engine(3);
  PackedSet packed(random_set(5000, 0.3, engine)), again;
  ArchiveWriter writer;
  writer(packed);
  const std::string bytes = writer.take();
  ArchiveReader reader(bytes);
  reader(again);
  EXPECT_TRUE(reader.complete());
  GaussianSet a, b;
  packed.unpack(a);
  again.unpack(b);
  expect_same(a, b);
}

TEST(PackedSet, BytesThatLieAreRefused) {
  const auto is_refused = [](std::uint64_t size, std::vector<std::uint64_t> packed) {
    ArchiveWriter writer;
    writer(size, packed);
    const std::string bytes = writer.take();
    ArchiveReader reader(bytes);
    PackedSet set;
    reader(set);
    return reader.failed() && set.size() == 0;
  };
  EXPECT_FALSE(is_refused(70, {3, 1, 1}));
  EXPECT_TRUE(is_refused(70, {3, 1}));                 // a word is missing
  EXPECT_TRUE(is_refused(70, {1, 1, 1}));              // one too many
  EXPECT_TRUE(is_refused(70, {4, 1}));                 // a word beyond the end
  EXPECT_TRUE(is_refused(70, {2, 64}));                // a Gaussian beyond the end
  EXPECT_TRUE(is_refused(70, {1, 0}));                 // a word that is empty
  EXPECT_TRUE(is_refused(~std::uint64_t{0}, {1, 1}));  // more than there is
}

}  // namespace
}  // namespace sgs::map
