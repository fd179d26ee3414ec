// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/view_candidates.h"

#include <gmock/gmock.h>

namespace sgs::mapper {
namespace {

TEST(ViewCandidates, EveryNthVisitLooksAtEverything) {
  ViewCandidates views(3);
  for (int round = 0; round < 3; ++round) {
    const auto all = views.next(1, 100);
    EXPECT_EQ(all.candidates, nullptr);
    ASSERT_NE(all.reached, nullptr);
    all.reached->clear(100);
    all.reached->insert(7 + static_cast<std::size_t>(round));
    EXPECT_NE(views.next(0, 100).candidates == nullptr, round != 0);  // others count on their own
    for (int visit = 1; visit < 3; ++visit) {
      const auto some = views.next(1, 100);
      EXPECT_EQ(some.reached, nullptr);
      ASSERT_NE(some.candidates, nullptr);
      EXPECT_EQ(some.candidates->count(), 1u);
      EXPECT_TRUE(some.candidates->contains(7 + static_cast<std::size_t>(round)));
    }
  }
}

TEST(ViewCandidates, IntervalOneAlwaysLooksAtEverything) {
  ViewCandidates views(1);
  for (int visit = 0; visit < 3; ++visit) {
    EXPECT_EQ(views.next(0, 100).candidates, nullptr);
    EXPECT_EQ(views.next(0, 100).reached, nullptr);
  }
}

TEST(ViewCandidates, NewGaussiansAreNoted) {
  ViewCandidates views(3);
  views.next(0, 100).reached->clear(100);
  const auto grown = views.next(0, 120);
  EXPECT_NE(grown.candidates, nullptr);
  ASSERT_EQ(grown.reached, grown.candidates);
  grown.reached->clear(120);  // as the rasterizer does
  grown.reached->insert(110);
  const auto known = views.next(0, 120);
  EXPECT_EQ(known.reached, nullptr);
  ASSERT_NE(known.candidates, nullptr);
  EXPECT_TRUE(known.candidates->contains(110));
  EXPECT_EQ(views.next(0, 120).candidates, nullptr);
}

TEST(ViewCandidates, FollowsRemovals) {
  ViewCandidates views(2);
  auto* reached = views.next(0, 100).reached;
  reached->clear(100);
  reached->insert(50);
  reached->insert(99);
  map::GaussianSet removed;
  removed.clear(130);  // the map has grown since
  for (const std::size_t i : {3u, 50u, 120u}) removed.insert(i);
  views.follow_removal(removed);
  const auto* candidates = views.next(0, 100).candidates;
  ASSERT_NE(candidates, nullptr);
  EXPECT_EQ(candidates->size(), 98u);
  EXPECT_EQ(candidates->count(), 1u);
  EXPECT_TRUE(candidates->contains(97));
}

}  // namespace
}  // namespace sgs::mapper
