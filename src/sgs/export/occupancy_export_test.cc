// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/occupancy_export.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "sgs/occupancy/floor.h"
#include "sgs/synthetic/floor_plan.h"
#include "sgs/synthetic/scene.h"
#include "sgs/synthetic/source.h"

namespace sgs::run {
namespace {

using occupancy::Cell;

const PinholeCamera kCamera{160, 120, 133.85, 134.8, 79.6, 61.5};
constexpr double kEye_m = 1.4;
const occupancy::HeightBand kBand;

/// Somebody who walks through the plan, looks ahead and to both sides, and down a little.
std::vector<SE3> walk_through(const synthetic::FloorPlan& plan) {
  constexpr double kEvery_m = 0.2, kDown = 0.3;
  const synthetic::Walk walk(plan.route);
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // the camera's axes to x forward, y left, z up
  std::vector<SE3> poses;
  for (double at = 0; at < walk.length_m(); at += kEvery_m) {
    const Eigen::Vector2d here = walk.at(at), way = walk.ahead(at);
    for (const double side : {0.0, 1.2, -1.2}) {
      const double yaw = std::atan2(way.y(), way.x()) + side;
      const Eigen::Matrix3d turn = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(kDown, Eigen::Vector3d::UnitY()))
                                       .toRotationMatrix();
      poses.push_back({turn * R, {here.x(), here.y(), kEye_m}});
    }
  }
  return poses;
}

/// Whether a place lies in a wall: in no room and in no opening.
bool in_a_wall(const synthetic::FloorPlan& plan, const Eigen::Vector2d& p) {
  constexpr double kHalfDoor_m = 0.5, kHalfWall_m = 0.05;
  for (const auto& room : plan.rooms) {
    if (room.area.contains(Eigen::Vector2f(p.cast<float>()))) return false;
  }
  for (const auto& door : plan.doors) {
    const Eigen::Vector2d d = (p - door.centre.cast<double>()).cwiseAbs();
    if (d.minCoeff() <= kHalfWall_m && d.maxCoeff() < kHalfDoor_m) return false;
  }
  return true;
}

/// The exact plan in the cells of a grid: where a surface of the scene stands in the band, and what
/// can be walked to from where the route begins.
class Truth {
 public:
  Truth(const synthetic::Scene& scene, const synthetic::FloorPlan& plan,
        const occupancy::OccupancyGrid& grid)
      : grid_(grid), cells_(grid.cells.size(), Cell::kUnknown) {
    for (const auto& primitive : scene.primitives) mark(primitive);
    for (int y = 0; y < grid.height; ++y) {
      for (int x = 0; x < grid.width; ++x) {
        if (in_a_wall(plan, middle(x, y))) at(x, y) = Cell::kOccupied;
      }
    }
    fill(plan.route.front());
  }

  Cell at(int x, int y) const { return cells_[index(x, y)]; }
  Eigen::Vector2d middle(int x, int y) const {
    return grid_.origin_m + grid_.resolution_m * Eigen::Vector2d(x + 0.5, y + 0.5);
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width) +
           static_cast<std::size_t>(x);
  }
  Cell& at(int x, int y) { return cells_[index(x, y)]; }

  void mark(const Eigen::Vector3f& p) {
    if (p.z() < kBand.low_m || p.z() > kBand.high_m) return;
    const Eigen::Vector2i cell =
        ((p.head<2>().cast<double>() - grid_.origin_m) / grid_.resolution_m)
            .array()
            .floor()
            .cast<int>();
    if (cell.minCoeff() < 0 || cell.x() >= grid_.width || cell.y() >= grid_.height) return;
    at(cell.x(), cell.y()) = Cell::kOccupied;
  }
  /// Points of a surface, a centimetre apart.
  void mark(const synthetic::Primitive& p) {
    constexpr float kStep_m = 0.01f;
    const bool quad = p.kind == synthetic::Primitive::Kind::kQuad;
    const Eigen::Vector3f u = quad ? p.u : Eigen::Vector3f::UnitX();
    const Eigen::Vector3f v = quad ? p.v : Eigen::Vector3f::UnitY();
    const float half_u = quad ? p.half_u : p.radius, half_v = quad ? p.half_v : p.radius;
    for (float a = -half_u; a <= half_u; a += kStep_m) {
      for (float b = -half_v; b <= half_v; b += kStep_m) {
        if (quad || a * a + b * b <= p.radius * p.radius) mark(p.centre + a * u + b * v);
      }
    }
  }
  void fill(const Eigen::Vector2d& start) {
    const Eigen::Vector2i first =
        ((start - grid_.origin_m) / grid_.resolution_m).array().floor().cast<int>();
    std::vector<Eigen::Vector2i> open = {first};
    while (!open.empty()) {
      const Eigen::Vector2i here = open.back();
      open.pop_back();
      if (here.minCoeff() < 0 || here.x() >= grid_.width || here.y() >= grid_.height) continue;
      if (at(here.x(), here.y()) != Cell::kUnknown) continue;
      at(here.x(), here.y()) = Cell::kFree;
      for (const Eigen::Vector2i& step : {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0),
                                          Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)}) {
        open.push_back(here + step);
      }
    }
  }

  const occupancy::OccupancyGrid& grid_;
  std::vector<Cell> cells_;
};

// A walk through a flat of three rooms and a corridor with exact depth: what is free is what can be
// walked on, and nothing inside a wall is.
TEST(OccupancyOfARun, TheFlatsPlan) {
  synthetic::SynthOptions options;
  options.scene = "flat";
  options.camera = kCamera;
  const auto scene = *synthetic::make_scene(options);
  const auto plan = *synthetic::floor_plan("flat");
  ThreadPool pool(2);
  RunOccupancy seen({});
  occupancy::FloorFinder floor;
  for (const SE3& T : walk_through(plan)) {
    const auto view = synthetic::render_exact(*scene, kCamera, T, pool);
    const auto samples = occupancy::sample_depth(
        kCamera, view.depth,
        occupancy::stride_for(kCamera, seen.volume.voxel_m(), seen.volume.range_m()));
    floor.add(samples, T, seen.volume.range_m());
    ASSERT_TRUE(seen.volume.add(samples, T));
  }
  seen.floor_m = floor.height_m();
  ASSERT_TRUE(seen.floor_m);
  EXPECT_NEAR(*seen.floor_m, 0, 0.01);
  const auto grid = grid_of_run(seen, kBand);
  ASSERT_TRUE(grid) << grid.error().text();
  const Truth truth(*scene, plan, *grid);
  int both = 0, either = 0, in_walls = 0;
  for (int y = 0; y < grid->height; ++y) {
    for (int x = 0; x < grid->width; ++x) {
      const bool free = grid->at(x, y) == Cell::kFree, wanted = truth.at(x, y) == Cell::kFree;
      both += free && wanted ? 1 : 0;
      either += free || wanted ? 1 : 0;
      if (free && in_a_wall(plan, truth.middle(x, y))) ++in_walls;
    }
  }
  RecordProperty("free_cells", both);
  RecordProperty("free_cells_here_or_there", either);
  EXPECT_GE(both, 0.95 * either) << both << " of " << either << " cells";
  EXPECT_EQ(in_walls, 0);
}

TEST(OccupancyOfARun, WithoutAFloorThereIsNoGrid) {
  const RunOccupancy seen({});
  const auto grid = grid_of_run(seen, kBand);
  ASSERT_FALSE(grid);
  EXPECT_THAT(grid.error().remedy, ::testing::HasSubstr("--camera-height"));
}

}  // namespace
}  // namespace sgs::run
