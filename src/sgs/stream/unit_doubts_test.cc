// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/unit_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::stream {
namespace {

using testing::HasSubstr;

/// All that is said of 30 times, `step` apart.
std::vector<std::string> said_of(double first, double step) {
  UnitDoubts doubts;
  std::vector<std::string> said;
  for (int i = 0; i < 30; ++i) {
    if (auto what = doubts.of_time(first + step * i)) said.push_back(*what);
  }
  return said;
}

std::vector<std::string> said_of_depth(float depth_m) {
  UnitDoubts doubts;
  std::vector<std::string> said;
  for (int i = 0; i < 30; ++i) {
    DepthImage depth(8, 6, i == 0 ? 0.0f : depth_m);  // the first shows nothing
    depth(0, 0) = 0;
    if (auto what = doubts.of_depth(depth)) said.push_back(*what);
  }
  return said;
}

TEST(UnitDoubts, SecondsOfWhateverClockAreNotDoubted) {
  for (const double first : {0.0, 12.5, 1.7e9}) {
    EXPECT_TRUE(said_of(first, 1 / 30.0).empty()) << first;
    EXPECT_TRUE(said_of(first, 0.5).empty()) << first;
  }
}

TEST(UnitDoubts, OtherUnitsOfTimeAreNamedOnce) {
  const auto one = [](const std::vector<std::string>& said) {
    return said.size() == 1 ? said.front() : fmt::format("{} times", said.size());
  };
  EXPECT_THAT(one(said_of(1.7e12, 33)), HasSubstr("milliseconds"));
  EXPECT_THAT(one(said_of(5000, 33)), HasSubstr("divide it by 1000"));
  EXPECT_THAT(one(said_of(5000.25, 33.3667)), HasSubstr("milliseconds"));
  EXPECT_THAT(one(said_of(1.7e15, 33'333)), HasSubstr("microseconds"));
  EXPECT_THAT(one(said_of(1.7e18, 33'333'333)), HasSubstr("nanoseconds"));
  EXPECT_THAT(one(said_of(0, 1)), HasSubstr("frame numbers"));
}

TEST(UnitDoubts, MasksTheOtherWayRoundAreToldOnce) {
  const auto said_of_masks = [](int moving_columns) {
    UnitDoubts doubts;
    std::vector<std::string> said;
    PixelMask still(10, 2, std::uint8_t{1});
    for (int x = 0; x < moving_columns; ++x) still(x, 0) = still(x, 1) = 0;
    for (int i = 0; i < 30; ++i) {
      if (auto what = doubts.of_mask(i % 2 == 0 ? &still : nullptr)) said.push_back(*what);
    }
    return said;
  };
  EXPECT_TRUE(said_of_masks(6).empty());
  ASSERT_EQ(said_of_masks(9).size(), 1U);
  EXPECT_THAT(said_of_masks(9).front(), HasSubstr("90 % of the picture move"));
}

TEST(UnitDoubts, DepthThatNoCameraSeesIsToldOnce) {
  EXPECT_TRUE(said_of_depth(0.08f).empty());
  EXPECT_TRUE(said_of_depth(60).empty());
  ASSERT_EQ(said_of_depth(1500).size(), 1U);
  EXPECT_THAT(said_of_depth(1500).front(), HasSubstr("farther than 1500 m"));
  EXPECT_THAT(said_of_depth(0.0015f).front(), HasSubstr("nearer than 0.0015 m"));
}

}  // namespace
}  // namespace sgs::stream
