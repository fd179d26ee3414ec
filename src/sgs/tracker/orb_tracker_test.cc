// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/orb_tracker.h"

#include <gtest/gtest.h>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/tracker/test_tracker.h"

namespace sgs::tracker {
namespace {

TrackerConfig orb_config() {
  TrackerConfig config;
  config.type = TrackerType::kOrb;
  config.orb.features = 500;
  return config;
}

double error_m(const TrackResult& r, int i) {
  return (r.T_odom_camera.t - alignment::wall_pose(i).t).norm();
}

TEST(OrbTracker, StaysWithinAMillimetreOrTwoAlongATexturedWall) {
  const auto tracker = must_make(orb_config(), alignment::kWallCamera, alignment::wall_pose(0));
  EXPECT_FALSE(tracker->follows_map());
  int keyframes = 0;
  for (int i = 0; i < 40; ++i) {
    const TrackResult r = tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
    EXPECT_EQ(r.status, TrackingStatus::kOk);
    EXPECT_LT(error_m(r, i), 0.005) << i;
    EXPECT_EQ(r.diagnostics.prior_source, PriorSource::kOrb);
    keyframes += r.keyframe;
  }
  EXPECT_GE(keyframes, 2);  // 32 cm at 18 cm per keyframe
  EXPECT_LE(keyframes, 12);
}

TEST(OrbTracker, DiesAtAWhiteWallAndFindsItselfWhenTextureReturns) {
  const auto tracker = must_make(orb_config(), alignment::kWallCamera, alignment::wall_pose(0));
  TrackResult last;
  for (int i = 0; i < 10; ++i)
    last = tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
  for (int i = 10; i < 20; ++i) {
    const TrackResult r =
        tracker->track(alignment::see_wall(alignment::wall_pose(i), i, false), nullptr);
    EXPECT_EQ(r.status, TrackingStatus::kLost);
    EXPECT_FALSE(r.keyframe);
    EXPECT_EQ(r.T_odom_camera.t, last.T_odom_camera.t);
  }
  // Far from where it was lost: only the search among keyframes can find it, within its interval.
  int found = -1;
  for (int i = 20; i < 32 && found < 0; ++i) {
    const SE3 back = alignment::wall_pose(2);
    const TrackResult r = tracker->track(alignment::see_wall(back, i), nullptr);
    if (r.status == TrackingStatus::kLost) continue;
    found = i;
    EXPECT_LT((r.T_odom_camera.t - back.t).norm(), 0.005);
  }
  EXPECT_GE(found, 20);
  EXPECT_LE(found, 25);
}

TEST(OrbTracker, StartsWithTheFirstFrameThatHasFeatures) {
  const auto tracker = must_make(orb_config(), alignment::kWallCamera, alignment::wall_pose(0));
  const TrackResult blank =
      tracker->track(alignment::see_wall(alignment::wall_pose(0), 0, false), nullptr);
  EXPECT_EQ(blank.status, TrackingStatus::kLost);
  EXPECT_EQ(blank.T_odom_camera.t, alignment::wall_pose(0).t);
  const TrackResult r = tracker->track(alignment::see_wall(alignment::wall_pose(0), 1), nullptr);
  EXPECT_EQ(r.status, TrackingStatus::kOk);
  EXPECT_TRUE(r.keyframe);
}

TEST(OrbTracker, SameInputGivesTheSameBits) {
  const auto a = must_make(orb_config(), alignment::kWallCamera, alignment::wall_pose(0)),
             b = must_make(orb_config(), alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 8; ++i) {
    const RgbdFrame frame = alignment::see_wall(alignment::wall_pose(i), i);
    EXPECT_EQ(a->track(frame, nullptr).T_odom_camera.t, b->track(frame, nullptr).T_odom_camera.t);
  }
}

}  // namespace
}  // namespace sgs::tracker
