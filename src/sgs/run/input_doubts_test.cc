// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/input_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::run {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<slam::FrameRecord> records(int good, int bad) {
  std::vector<slam::FrameRecord> frames(static_cast<std::size_t>(good + bad));
  for (std::size_t i = static_cast<std::size_t>(good); i < frames.size(); ++i) {
    frames[i].bad = true;
    frames[i].bad_reason = "no such file";
  }
  return frames;
}

TEST(InputDoubts, HardlyAnyFrameIsSaidWithTheReason) {
  dataset::SequenceInfo info;
  EXPECT_FALSE(too_few_frames(records(10, 90), {}, info));
  EXPECT_THAT(too_few_frames(records(9, 91), {}, info).value_or(""), HasSubstr("no such file"));
  // Images without depth are no frames at all.
  info.color_images = 200;
  EXPECT_THAT(too_few_frames(records(2, 0), {}, info).value_or(""), HasSubstr("2 of 200"));
  InputSpec part;
  part.frames = "0:2";
  EXPECT_FALSE(too_few_frames(records(2, 0), part, info));
}

TEST(InputDoubts, SpeedsThatNoHandHasAndAnotherScaleAreDoubted) {
  const auto at = [](double metres_a_frame, double step_s) {
    run::Run run;
    for (int i = 0; i < 30; ++i) {
      SE3 T;
      T.t.x() = metres_a_frame * i;
      run.trajectory.push_back({step_s * i, T});
    }
    return run;
  };
  EXPECT_THAT(doubts_about_units(at(0.01, 1.0 / 30), {}), IsEmpty());
  EXPECT_THAT(doubts_about_units(at(0.2, 1.0 / 30), {}).at(0), HasSubstr("fast"));
  EXPECT_THAT(doubts_about_units(at(0.01, 33), {}).at(0), HasSubstr("slow"));
  eval::Metrics scores;
  scores.scale_error_percent = 300;
  EXPECT_THAT(doubts_about_units(at(0.01, 1.0 / 30), scores).at(0), HasSubstr("300 % larger"));
}

}  // namespace
}  // namespace sgs::run
