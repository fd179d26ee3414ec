// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/movers.h"

#include <gtest/gtest.h>

#include <utility>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/tracker/test_tracker.h"

namespace sgs::tracker {
namespace {

TEST(Movers, ChangeNothingWhereNothingMoves) {
  TrackerConfig with, without;
  with.movers.clusters = true;
  without.movers.clusters = false;
  const auto a = must_make(with, alignment::kWallCamera, alignment::wall_pose(0));
  const auto b = must_make(without, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 20; ++i) {
    const RgbdFrame frame = alignment::see_wall(alignment::wall_pose(i), i);
    EXPECT_EQ(a->track(frame, nullptr).T_odom_camera.t, b->track(frame, nullptr).T_odom_camera.t);
  }
}

/// Somebody goes along with the camera, and a mask says so.
RgbdFrame frame_with_company(int index) {
  constexpr int kLeft = 20, kRight = 240;
  RgbdFrame frame = alignment::see_wall(alignment::wall_pose(index), index);
  PixelMask still(frame.camera.width, frame.camera.height, std::uint8_t{1});
  for (int v = 0; v < still.height(); ++v) {
    for (int u = kLeft; u < kRight; ++u) {
      const std::uint8_t g = alignment::wallpaper(40 + 0.004 * u, 0.004 * v);
      frame.color(u, v) = {g, g, g};
      frame.depth(u, v) = 1.0f;
      still(u, v) = 0;
    }
  }
  frame.still = std::make_shared<const PixelMask>(std::move(still));
  return frame;
}

TEST(Movers, AMaskThatCameWithTheFrameIsBelieved) {
  TrackerConfig config;
  config.movers.clusters = false;
  const auto told = must_make(config, alignment::kWallCamera, alignment::wall_pose(0));
  const auto not_told = must_make(config, alignment::kWallCamera, alignment::wall_pose(0));
  TrackResult with, without;
  for (int i = 0; i < 20; ++i) {
    RgbdFrame frame = frame_with_company(i);
    const auto still = std::exchange(frame.still, nullptr);
    without = not_told->track(frame, nullptr);
    leave_out_movers(frame, still);
    with = told->track(frame, nullptr);
  }
  const Eigen::Vector3d truth = alignment::wall_pose(19).t;
  EXPECT_NE(with.status, TrackingStatus::kLost);
  EXPECT_LT((with.T_odom_camera.t - truth).norm(), 0.01);
  EXPECT_GT((without.T_odom_camera.t - truth).norm(), 0.05);
  EXPECT_NEAR(with.diagnostics.movers, 220.0 / 320, 0.01);
  EXPECT_FALSE(without.diagnostics.movers > 0);
}

}  // namespace
}  // namespace sgs::tracker
