// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/video_gap.h"

#include <gtest/gtest.h>

#include <limits>

namespace sgs::slam {
namespace {

double frames_between(double gap_s, double moved_m, double turned_rad) {
  return video_frames_between({1, SE3{}},
                              {1 + gap_s, {so3_exp({0, turned_rad, 0}), {moved_m, 0, 0}}}, 100);
}

TEST(VideoGap, AVideoCountsFrameByFrame) {
  EXPECT_EQ(frames_between(1 / 30.0, 0.02, 0.03), 1);
  EXPECT_EQ(frames_between(0.037, 0.02, 0.03), 1);
  EXPECT_EQ(frames_between(1 / 60.0, 0.01, 0), 1);
}

TEST(VideoGap, TimeCountsAndSoDoJumps) {
  EXPECT_EQ(frames_between(0.5, 0, 0), 15);
  EXPECT_NEAR(frames_between(1 / 30.0, 0.4, 0), 40, 1e-9);
  EXPECT_NEAR(frames_between(1 / 30.0, 0, 0.5), 28.6, 0.1);
  EXPECT_EQ(frames_between(0.1, 0.1, 0.1), 3);
}

TEST(VideoGap, IsBoundedAndNeverLessThanOne) {
  EXPECT_EQ(frames_between(1e9, 0, 0), 100);
  EXPECT_EQ(frames_between(0, 1e9, 0), 100);
  EXPECT_EQ(frames_between(-5, 0, 0), 1);
  EXPECT_EQ(frames_between(std::numeric_limits<double>::quiet_NaN(), 0, 0), 1);
}

}  // namespace
}  // namespace sgs::slam
