// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::run {
namespace {

Input four_frames() {
  InputSpec spec;
  spec.input = "synth:room_desk";
  spec.frames = "0:4";
  return std::move(*open_input(spec, 1));
}

TEST(Calibrate, AFewFramesDoNotTell) {
  Input input = four_frames();
  int frames = 0;
  const auto estimate = calibrate(input, {}, [&](const auto&, const auto*) { ++frames; });
  ASSERT_TRUE(estimate) << estimate.error().text();
  EXPECT_EQ(frames, 4);
  EXPECT_THAT(estimate->why_not, testing::HasSubstr("keyframes"));
  EXPECT_FALSE(estimate->useful());
}

TEST(Calibrate, ATrackerThatNeedsAMapIsRefused) {
  Input input = four_frames();
  const auto estimate = calibrate(input, slam::make_session_config(slam::Preset::kPaper), {});
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(estimate.error().remedy, testing::HasSubstr("--tracker spectral"));
}

TEST(Calibrate, AStopIsAnInterruption) {
  Input input = four_frames();
  std::stop_source stop;
  const auto estimate = calibrate(
      input, {}, [&](const auto&, const auto*) { stop.request_stop(); }, stop.get_token());
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, ErrorCode::kInterrupted);
}

}  // namespace
}  // namespace sgs::run
