// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/occupancy/distance.h"
#include "sgs/occupancy/floor.h"
#include "sgs/occupancy/grid.h"
#include "sgs/occupancy/volume.h"

namespace sgs::occupancy {
namespace {

using ::testing::HasSubstr;

const PinholeCamera kCamera{80, 60, 66.9, 67.4, 39.8, 30.6};
/// An empty room.
constexpr double kFloor_m = 0.31;
const Eigen::AlignedBox3d kRoom(Eigen::Vector3d(0.02, 0.02, kFloor_m),
                                Eigen::Vector3d(4.02, 3.02, 2.8));

/// A level camera at `t` that looks along `yaw`, tilted downwards.
SE3 looking(const Eigen::Vector3d& t, double yaw, double down) {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // x right, y down, z forward to x forward, y left, z up
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(down, Eigen::Vector3d::UnitY()))
                                   .toRotationMatrix();
  return {turn * R, t};
}

DepthImage room_from(const SE3& T) {
  DepthImage depth(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d d = T.R * kCamera.back_project(u, v, 1);
      double z = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) {
        const double wall = d[k] > 0 ? kRoom.max()[k] : kRoom.min()[k];
        if (d[k] != 0) z = std::min(z, (wall - T.t[k]) / d[k]);
      }
      depth(u, v) = static_cast<float>(z);
    }
  }
  return depth;
}

struct Seen {
  OccupancyVolume volume;
  FloorFinder floor;

  explicit Seen(const VolumeConfig& config = {}) : volume(config) {}
  void look(const SE3& T, const DepthImage& depth) {
    const auto samples = sample_depth(kCamera, depth, 1);
    floor.add(samples, T, volume.range_m());
    EXPECT_TRUE(volume.add(samples, T));
  }
  void look_around() {
    for (const double x : {1.0, 3.0}) {
      for (int i = 0; i < 16; ++i) {
        const SE3 T = looking({x, 1.5, 1.5}, i * std::numbers::pi / 8, 0.3);
        look(T, room_from(T));
      }
    }
  }
};

TEST(DepthSamples, NormalsAndAreas) {
  const SE3 T = looking({1, 1.5, 1.5}, 0, 0);
  double area = 0;
  for (const DepthSample& sample : sample_depth(kCamera, room_from(T), 2)) {
    const Eigen::Vector3d p = T * sample.point, n = T.R * sample.normal;
    if (p.x() < 4.01 || std::abs(p.y() - 1.5) > 1 || std::abs(p.z() - 1.5) > 0.8) continue;
    EXPECT_LT((n - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-3);
    area += sample.area_m2;
  }
  EXPECT_NEAR(area, 2 * 1.6, 0.25);
}

TEST(OccupancyVolume, ARoom) {
  Seen seen;
  seen.look_around();
  const auto at = [&](double x, double y, double z) {
    return seen.volume.at((Eigen::Vector3d(x, y, z) / 0.05).array().floor().cast<int>());
  };
  EXPECT_EQ(at(2, 1.5, 1), Cell::kFree);
  EXPECT_EQ(at(0.02, 1.5, 1), Cell::kOccupied);
  EXPECT_EQ(at(0.08, 1.5, 1), Cell::kFree);
  EXPECT_EQ(at(-0.03, 1.5, 1), Cell::kUnknown);
  EXPECT_EQ(at(3.52, 2.52, kFloor_m), Cell::kOccupied);
  EXPECT_EQ(at(2, 1.5, kFloor_m), Cell::kUnknown);  // below the view of both cameras
  EXPECT_EQ(at(100, 1, 1), Cell::kUnknown);
}

// A point in the air that a single view claims is no surface, and what one view alone saw is not
// known.
TEST(OccupancyVolume, OneViewIsNotBelieved) {
  Seen seen;
  DepthImage depth = room_from(looking({1, 1.5, 1.5}, 0, 0));
  depth(40, 30) = 1.01f;
  seen.look(looking({1, 1.5, 1.5}, 0, 0), depth);
  const Eigen::Vector3i inside(40, 29, 30);  // that of the point at (2.01, 1.497, 1.509)
  EXPECT_EQ(seen.volume.at(inside), Cell::kUnknown);
  seen.look_around();
  EXPECT_EQ(seen.volume.at(inside), Cell::kFree);
}

TEST(FloorFinder, LowestLevelSurface) {
  Seen seen;
  EXPECT_FALSE(seen.floor.height_m());
  seen.look_around();
  ASSERT_TRUE(seen.floor.height_m());
  EXPECT_NEAR(*seen.floor.height_m(), kFloor_m, 0.005);
}

TEST(OccupancyGrid, TheRoomsPlan) {
  Seen seen;
  seen.look_around();
  const auto grid = make_grid(seen.volume, kFloor_m, {0.1, 1.5});
  ASSERT_TRUE(grid) << grid.error().text();
  // Walls at 0.02 and 4.02, 3.02 lie in the cells from 0 on.
  EXPECT_EQ(grid->width, 81);
  EXPECT_EQ(grid->height, 61);
  EXPECT_NEAR(grid->origin_m.norm(), 0, 1e-9);
  int wrong = 0;
  for (int y = 0; y < grid->height; ++y) {
    for (int x = 0; x < grid->width; ++x) {
      const bool wall = x == 0 || y == 0 || x == 80 || y == 60;
      const Cell wanted = wall ? Cell::kOccupied : Cell::kFree;
      if (grid->at(x, y) != wanted) ++wrong;
    }
  }
  EXPECT_LE(wrong, 4);  // corners, which hardly any ray meets
}

TEST(Distance, ToTheNearestSurface) {
  Seen seen({.voxel_m = 0.1});
  seen.look_around();
  std::vector<Eigen::Vector3i> occupied;
  seen.volume.for_each([&](const Eigen::Vector3i& voxel, Cell cell) {
    if (cell == Cell::kOccupied) occupied.push_back(voxel);
  });
  int visited = 0;
  const Status status =
      for_each_distance(seen.volume, 1, [&](const Eigen::Vector3i& voxel, double metres) {
        if (++visited % 97 != 0) return;
        double nearest = 1;
        for (const Eigen::Vector3i& o : occupied) {
          nearest = std::min(nearest, 0.1 * (o - voxel).cast<double>().norm());
        }
        EXPECT_NEAR(metres, nearest, 1e-6);
      });
  EXPECT_TRUE(status);
  EXPECT_GT(visited, 10'000);
}

TEST(OccupancyGrid, NothingBetweenTheHeights) {
  Seen seen;
  seen.look_around();
  EXPECT_THAT(make_grid(seen.volume, 50, {0.1, 1.5}).error().message, HasSubstr("50.00 m"));
  EXPECT_THAT(make_grid(seen.volume, kFloor_m, {0.1, 0.11}).error().remedy,
              HasSubstr("--resolution"));
}

TEST(OccupancyGrid, TheFilesOfMapServer) {
  const io::TemporaryFolder folder;
  const OccupancyGrid grid{
      0.05,
      {-1.5, 2},
      3,
      2,
      {Cell::kFree, Cell::kOccupied, Cell::kUnknown, Cell::kOccupied, Cell::kFree, Cell::kFree}};
  ASSERT_TRUE(save_grid(folder / "it's.yaml", grid, "a comment"));
  EXPECT_EQ(*io::read_file(folder / "it's.yaml"),
            "# a comment\nimage: 'it''s.pgm'\nmode: trinary\nresolution: 0.05\n"
            "origin: [-1.500000, 2.000000, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
            "free_thresh: 0.196\n");
  const std::string picture = *io::read_file(folder / "it's.pgm");
  EXPECT_THAT(picture, ::testing::StartsWith("P5\n# 0.05 m per pixel\n3 2\n255\n"));
  // The row of the largest y first.
  EXPECT_EQ(picture.substr(picture.size() - 6), std::string("\0\xfe\xfe\xfe\0\xcd", 6));
}

}  // namespace
}  // namespace sgs::occupancy
