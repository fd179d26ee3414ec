// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/depth_stamps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::dataset {
namespace {

using testing::HasSubstr;

/// Stamps of depth at 30 Hz, by so much later than colour.
std::vector<double> stamps(const std::vector<double>& delays_s) {
  std::vector<double> out;
  for (std::size_t i = 0; i < delays_s.size(); ++i) {
    out.push_back(100 + static_cast<double>(i) / 30 + delays_s[i]);
  }
  return out;
}

TEST(DepthStamps, SummaryIsEmptyWhereDepthHasNone) {
  EXPECT_FALSE(summarize_delays({}));
  EXPECT_FALSE(summarize_delays({0, 0, 0}));
}

TEST(DepthStamps, SummaryHasTheEndsAndTheMiddle) {
  const auto delays = summarize_delays({0.02, -0.01, 0.004, 0, 0.006});
  ASSERT_TRUE(delays);
  EXPECT_EQ(delays->least_s, -0.01);
  EXPECT_EQ(delays->median_s, 0.004);
  EXPECT_EQ(delays->most_s, 0.02);
}

TEST(DepthStamps, ThoseOfOneClockAreBelieved) {
  const std::vector<double> none(5, 0.0), late(5, 0.0166), early(5, -0.0333);
  for (const auto& delays_s : {none, late, early}) {
    EXPECT_FALSE(implausible_delays(delays_s, stamps(delays_s)));
  }
  // A few that are far off are not the clock.
  const std::vector<double> some = {0.01, 0.01, 0.2, 0.01, -0.3};
  EXPECT_FALSE(implausible_delays(some, stamps(some)));
  EXPECT_FALSE(implausible_delays({}, {}));
}

TEST(DepthStamps, ThoseOfAnotherClockAreNot) {
  for (const double off_s : {0.06, -0.06, 3600.0, -1.3e9}) {
    const std::vector<double> delays_s(5, off_s);
    const auto why = implausible_delays(delays_s, stamps(delays_s));
    ASSERT_TRUE(why) << off_s;
    EXPECT_THAT(*why, HasSubstr("not the clock of colour"));
    EXPECT_THAT(*why, HasSubstr("delay_s"));  // the remedy where it is a lag
  }
  const std::vector<double> delays_s(5, 0.06);
  EXPECT_THAT(*implausible_delays(delays_s, stamps(delays_s)), HasSubstr("60.0 ms"));
}

// As a column that somebody left at 0 has them, beside colour that begins at 0 too.
TEST(DepthStamps, ThoseThatStandStillAreNoTimes) {
  const std::vector<double> delays_s = {0, -0.01, -0.02, -0.03}, still(4, 0.0);
  const auto why = implausible_delays(delays_s, still);
  ASSERT_TRUE(why);
  EXPECT_THAT(*why, HasSubstr("all with the same time"));
  // One frame or two prove nothing.
  EXPECT_FALSE(implausible_delays({0.01}, {100.01}));
}

}  // namespace
}  // namespace sgs::dataset
