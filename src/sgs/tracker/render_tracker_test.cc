// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/render_tracker.h"

#include <gtest/gtest.h>

#include "sgs/tracker/test_wall_map.h"

namespace sgs::tracker {
namespace {

class RenderTracker : public testing::TestWithParam<RenderMethod> {};
INSTANTIATE_TEST_SUITE_P(Method, RenderTracker,
                         testing::Values(RenderMethod::kGaussNewton, RenderMethod::kAdam,
                                         RenderMethod::kAligned),
                         [](const auto& method) { return to_string(method.param); });

std::unique_ptr<Odometry> make_render_tracker(RenderMethod method) {
  TrackerConfig config;
  config.type = TrackerType::kRender;
  config.rendering.method = method;
  return must_make(config, alignment::kWallCamera, alignment::wall_pose(0));
}

TEST_P(RenderTracker, HoldsOnToTheDrawingOfAPaperedWall) {
  const auto tracker = make_render_tracker(GetParam());
  const auto map = wall_map();
  EXPECT_TRUE(tracker->follows_map());
  for (int i = 0; i < 12; ++i) {
    const TrackResult result =
        tracker->track(alignment::see_wall(alignment::wall_pose(i), i), i < 2 ? nullptr : map);
    ASSERT_NE(result.status, TrackingStatus::kLost) << i;
    EXPECT_LT((result.T_odom_camera.t - alignment::wall_pose(i).t).norm(), 0.01) << i;
    if (i == 0) continue;
    EXPECT_EQ(result.status, TrackingStatus::kDegenerate) << i;
    EXPECT_EQ(__builtin_popcount(result.diagnostics.degenerate_mask), 3) << i;
    EXPECT_TRUE(result.diagnostics.prior_active) << i;
  }
}

TEST_P(RenderTracker, SaysLostBeforeABareWallInsteadOfSliding) {
  const auto tracker = make_render_tracker(GetParam());
  tracker->track(alignment::see_wall(alignment::wall_pose(0), 0), nullptr);
  for (int i = 1; i < 4; ++i) {
    const TrackResult result =
        tracker->track(alignment::see_wall(alignment::wall_pose(i), i, false), wall_map(false));
    EXPECT_EQ(result.status, TrackingStatus::kLost) << i;
    EXPECT_NE(result.lost_reason, alignment::LostReason::kNone) << i;
  }
}

TEST_P(RenderTracker, AMapThatIsElsewhereIsALoss) {
  const auto tracker = make_render_tracker(GetParam());
  tracker->track(alignment::see_wall(alignment::wall_pose(0), 0), nullptr);
  auto elsewhere = std::make_shared<map::Snapshot>(*wall_map());
  for (map::Gaussian& g : elsewhere->gaussians) g.mean[2] -= 50;
  EXPECT_EQ(tracker->track(alignment::see_wall(alignment::wall_pose(1), 1), elsewhere).status,
            TrackingStatus::kLost);
}

TEST_P(RenderTracker, GivesTheSameBitsAgain) {
  const auto a = make_render_tracker(GetParam()), b = make_render_tracker(GetParam());
  const auto map = wall_map();
  for (int i = 0; i < 5; ++i) {
    const RgbdFrame frame = alignment::see_wall(alignment::wall_pose(i), i);
    EXPECT_EQ(a->track(frame, map).T_odom_camera.t, b->track(frame, map).T_odom_camera.t);
  }
}

}  // namespace
}  // namespace sgs::tracker
