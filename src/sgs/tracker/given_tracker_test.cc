// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/given_tracker.h"

#include <gtest/gtest.h>

#include <limits>

namespace sgs::tracker {
namespace {

RgbdFrame frame_at(const std::optional<SE3>& T_world_camera, float depth_m = 2) {
  RgbdFrame frame;
  frame.camera = {64, 48, 50, 50, 31.5, 23.5};
  frame.color = ColorImage(64, 48);
  frame.depth = DepthImage(64, 48, depth_m);
  frame.given_T_world_camera = T_world_camera;
  return frame;
}

SE3 moved(double x_m, double angle_rad = 0) { return {so3_exp({0, angle_rad, 0}), {x_m, 0, 0}}; }

TEST(GivenTracker, TakesPosesAsTheyAreHoweverFarApart) {
  GivenTracker tracker(GivenConfig{});
  for (const double x_m : {5.0, -3.0, 40.0}) {
    const TrackResult result = tracker.track(frame_at(moved(x_m, x_m)), {}, nullptr);
    EXPECT_EQ(result.status, TrackingStatus::kOk);
    EXPECT_EQ(result.T_odom_camera.t, moved(x_m).t);
    EXPECT_EQ(result.T_odom_camera.R, moved(x_m, x_m).R);
    EXPECT_TRUE(result.keyframe);
  }
  EXPECT_FALSE(tracker.needs_video());
  EXPECT_FALSE(tracker.follows_map());
}

TEST(GivenTracker, AFrameWithoutAUsablePoseIsLostAndTheNextOneIsNot) {
  GivenTracker tracker(GivenConfig{});
  EXPECT_EQ(tracker.track(frame_at(std::nullopt), {}, nullptr).lost_reason,
            alignment::LostReason::kNoPose);
  ASSERT_EQ(tracker.track(frame_at(moved(1)), {}, nullptr).status, TrackingStatus::kOk);
  const auto bad =
      tracker.track(frame_at(moved(std::numeric_limits<double>::quiet_NaN())), {}, nullptr);
  EXPECT_EQ(bad.status, TrackingStatus::kLost);
  EXPECT_EQ(bad.lost_reason, alignment::LostReason::kNotFinite);
  EXPECT_EQ(bad.T_odom_camera.t.x(), 1);
  EXPECT_FALSE(bad.keyframe);
  EXPECT_EQ(tracker.track(frame_at(moved(2)), {}, nullptr).status, TrackingStatus::kOk);
}

// 12 % of the depth, or 8 degrees.
TEST(GivenTracker, AViewFarFromTheLastKeyframeIsANewOne) {
  GivenTracker tracker(GivenConfig{});
  EXPECT_TRUE(tracker.track(frame_at(moved(0)), {}, nullptr).keyframe);
  EXPECT_FALSE(tracker.track(frame_at(moved(0.2)), {}, nullptr).keyframe);
  EXPECT_TRUE(tracker.track(frame_at(moved(0.2), 1), {}, nullptr).keyframe);
  EXPECT_FALSE(tracker.track(frame_at(moved(0.2, 0.1)), {}, nullptr).keyframe);
  EXPECT_TRUE(tracker.track(frame_at(moved(0.2, 0.2)), {}, nullptr).keyframe);
  // Without any depth a metre is assumed.
  EXPECT_TRUE(tracker.track(frame_at(moved(0.4, 0.2), 0), {}, nullptr).keyframe);
}

}  // namespace
}  // namespace sgs::tracker
