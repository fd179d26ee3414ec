// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sgs::tracker
