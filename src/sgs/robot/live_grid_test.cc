// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/robot/live_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::robot {
namespace {

const PinholeCamera kCamera{80, 60, 40, 40, 39.5, 29.5};
constexpr double kHeight_m = 0.6;  // of the camera over the floor
constexpr double kWall_m = 3;      // ahead of where the walk begins

/// A floor and a wall, seen by a level camera that has walked on so far.
std::shared_ptr<RgbdFrame> seen(std::int64_t index, double walked_m) {
  auto frame = std::make_shared<RgbdFrame>();
  frame->index = index;
  frame->camera = kCamera;
  frame->depth = DepthImage(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const double down = (v - kCamera.cy) / kCamera.fy;
      const double floor = down > 0 ? kHeight_m / down : kWall_m;
      frame->depth(u, v) = static_cast<float>(std::min(kWall_m - walked_m, floor));
    }
  }
  return frame;
}

/// From optical axes to x forward, y left, z up.
SE3 upright() {
  SE3 T;
  T.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

struct Walked {
  history::Path path;
  LiveGrid grid;

  explicit Walked(int views, const GridOptions& options = {}) : grid(options, upright()) {
    for (int k = 0; k < views; ++k) {
      const double z = 0.15 * k;
      path.append({k, 0.1 * k, SE3(Eigen::Matrix3d::Identity(), {0, 0, z})});
      grid.see(*seen(k, z), path);
    }
  }
};

occupancy::Cell cell_at(const occupancy::OccupancyGrid& grid, double x, double y) {
  const int column = static_cast<int>(std::floor((x - grid.origin_m.x()) / grid.resolution_m));
  const int row = static_cast<int>(std::floor((y - grid.origin_m.y()) / grid.resolution_m));
  if (column < 0 || row < 0 || column >= grid.width || row >= grid.height) {
    return occupancy::Cell::kUnknown;
  }
  return grid.at(column, row);
}

TEST(LiveGrid, FindsFreeFloorAndTheWall) {
  Walked walked(6);
  const auto grid = walked.grid.grid(walked.path);
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(cell_at(*grid, kWall_m + 0.01, 0.02), occupancy::Cell::kOccupied);
  EXPECT_EQ(cell_at(*grid, 1.52, 0.02), occupancy::Cell::kFree);
  EXPECT_EQ(cell_at(*grid, kWall_m + 0.5, 0.02), occupancy::Cell::kUnknown);
}

/// The same path a metre farther on.
history::Path moved_on(const history::Path& path) {
  history::Path moved;
  for (std::size_t k = 0; k < path.size(); ++k) {
    auto entry = path[k];
    entry.T_odom_camera.t.z() += 1;
    moved.append(entry);
  }
  return moved;
}

// Who asks waits for two views at a time; the grid is as it was until all are counted.
TEST(LiveGrid, CountsAnewAFewAtATime) {
  GridOptions options;
  options.recounted_at_once = 2;
  Walked walked(6, options), whole(6, options);
  const history::Path moved = moved_on(walked.path);
  for (int asked = 1; asked <= 3; ++asked) {
    const auto grid = walked.grid.grid(moved);
    ASSERT_TRUE(grid.has_value());
    const bool there = cell_at(*grid, kWall_m + 1.01, 0.02) == occupancy::Cell::kOccupied;
    EXPECT_EQ(there, asked == 3) << asked;
  }
  const auto at_once = whole.grid.whole_grid(moved), in_turn = walked.grid.grid(moved);
  ASSERT_TRUE(at_once && in_turn);
  EXPECT_EQ(at_once->cells, in_turn->cells);
}

TEST(LiveGrid, CountsAnewWhereThePastHasMoved) {
  Walked walked(6);
  ASSERT_TRUE(walked.grid.grid(walked.path).has_value());
  const history::Path moved = moved_on(walked.path);
  const auto grid = walked.grid.grid(moved);
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(cell_at(*grid, kWall_m + 1.01, 0.02), occupancy::Cell::kOccupied);
  EXPECT_NE(cell_at(*grid, kWall_m + 0.01, 0.02), occupancy::Cell::kOccupied);
}

TEST(LiveGrid, SaysNothingWithoutAFloor) {
  LiveGrid grid(GridOptions{}, upright());
  EXPECT_FALSE(grid.grid(history::Path{}).has_value());
}

}  // namespace
}  // namespace sgs::robot
