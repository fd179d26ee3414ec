// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/pairing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::dataset {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::map<long, std::filesystem::path> numbered(long first, long count) {
  std::map<long, std::filesystem::path> files;
  for (long i = 0; i < count; ++i) files.emplace(first + i, fmt::format("{}.png", first + i));
  return files;
}

TEST(Pairing, ASharedCounterPairsEqualNumbers) {
  FrameList list;
  // Depth begins later and lost one: both stop together.
  auto depth = numbered(12, 88);
  depth.erase(50);
  pair_by_number(numbered(10, 90), depth, 30, list);
  EXPECT_EQ(list.frames.size(), 87u);
  EXPECT_EQ(list.frames.front().depth, "12.png");
  EXPECT_THAT(list.warnings, IsEmpty());
}

TEST(Pairing, CountersOfTheirOwnPairInOrderAndDoubtIsSaid) {
  FrameList list;
  pair_by_number(numbered(57000, 90), numbered(57030, 90), 30, list);
  ASSERT_EQ(list.frames.size(), 90u);
  EXPECT_EQ(list.frames.front().color, "57000.png");
  EXPECT_EQ(list.frames.front().depth, "57030.png");
  EXPECT_THAT(list.warnings.at(0), HasSubstr("counter of its own"));
  FrameList doubtful;
  pair_by_number(numbered(57000, 90), numbered(57030, 95), 30, doubtful);
  EXPECT_EQ(doubtful.frames.front().depth, "57030.png");
  EXPECT_EQ(doubtful.frames.front().color, "57030.png");
  EXPECT_THAT(doubtful.warnings.at(0), HasSubstr("match = \"order\""));
}

}  // namespace
}  // namespace sgs::dataset
