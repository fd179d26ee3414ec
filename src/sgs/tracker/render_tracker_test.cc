// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/render_tracker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sgs/tracker/textured_wall.h"

namespace sgs::tracker {
namespace {

/// The papered wall as Gaussians: one in the middle of every tile, nearly as flat and as large.
map::SnapshotPtr wall_map(bool papered = true) {
  constexpr double kTile_m = 0.02;
  auto snapshot = std::make_shared<map::Snapshot>();
  snapshot->version = 1;
  for (double y = -1.4; y < 1.4; y += kTile_m) {
    for (double x = -1.6; x < 2.2; x += kTile_m) {
      map::Gaussian g{};
      g.mean[0] = static_cast<float>(x + kTile_m / 2);
      g.mean[1] = static_cast<float>(y + kTile_m / 2);
      g.mean[2] = static_cast<float>(kWallDistance_m);
      g.log_scale[0] = g.log_scale[1] = std::log(0.6f * static_cast<float>(kTile_m));
      g.log_scale[2] = std::log(0.001f);
      g.rotation[0] = 1;
      g.opacity_logit = 5;
      const double grey = papered ? wallpaper(x + kTile_m / 2, y + kTile_m / 2) : 128.0;
      for (float& c : g.rgb) c = static_cast<float>(grey / 255);
      snapshot->gaussians.push_back(g);
    }
  }
  snapshot->anchors.resize(snapshot->gaussians.size());
  return snapshot;
}

std::unique_ptr<Tracker> make_render_tracker() {
  TrackerConfig config;
  config.type = TrackerType::kRender;
  return *make_tracker(config, kWallCamera, wall_pose(0));
}

TEST(RenderTracker, HoldsOnToTheDrawingOfAPaperedWall) {
  const auto tracker = make_render_tracker();
  const auto map = wall_map();
  EXPECT_TRUE(tracker->follows_map());
  for (int i = 0; i < 12; ++i) {
    const TrackResult result = tracker->track(see_wall(wall_pose(i), i), i < 2 ? nullptr : map);
    ASSERT_NE(result.status, TrackingStatus::kLost) << i;
    EXPECT_LT((result.T_world_camera.t - wall_pose(i).t).norm(), 0.01) << i;
    if (i == 0) continue;
    EXPECT_EQ(result.status, TrackingStatus::kDegenerate) << i;
    EXPECT_EQ(__builtin_popcount(result.diagnostics.degenerate_mask), 3) << i;
    EXPECT_TRUE(result.diagnostics.prior_active) << i;
  }
}

TEST(RenderTracker, SaysLostBeforeABareWallInsteadOfSliding) {
  const auto tracker = make_render_tracker();
  tracker->track(see_wall(wall_pose(0), 0), nullptr);
  for (int i = 1; i < 4; ++i) {
    const TrackResult result = tracker->track(see_wall(wall_pose(i), i, false), wall_map(false));
    EXPECT_EQ(result.status, TrackingStatus::kLost) << i;
    EXPECT_NE(result.lost_reason, LostReason::kNone) << i;
  }
}

TEST(RenderTracker, AMapThatIsElsewhereIsALoss) {
  const auto tracker = make_render_tracker();
  tracker->track(see_wall(wall_pose(0), 0), nullptr);
  auto elsewhere = std::make_shared<map::Snapshot>(*wall_map());
  for (map::Gaussian& g : elsewhere->gaussians) g.mean[2] -= 50;
  EXPECT_EQ(tracker->track(see_wall(wall_pose(1), 1), elsewhere).status, TrackingStatus::kLost);
}

TEST(RenderTracker, GivesTheSameBitsAgain) {
  const auto a = make_render_tracker(), b = make_render_tracker();
  const auto map = wall_map();
  for (int i = 0; i < 5; ++i) {
    const RgbdFrame frame = see_wall(wall_pose(i), i);
    EXPECT_EQ(a->track(frame, map).T_world_camera.t, b->track(frame, map).T_world_camera.t);
  }
}

}  // namespace
}  // namespace sgs::tracker
