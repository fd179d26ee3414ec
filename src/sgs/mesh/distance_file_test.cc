// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mesh/distance_file.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <vector>

#include "sgs/io/temporary_folder.h"

namespace sgs::mesh {
namespace {

TEST(DistanceFile, MetresFromAWall) {
  const io::TemporaryFolder folder;
  occupancy::OccupancyVolume volume({.voxel_m = 0.1, .range_m = 4, .min_views = 1});
  std::vector<occupancy::DepthSample> samples;
  for (double y = -2; y <= 2; y += 0.05) {
    for (double z = -2; z <= 2; z += 0.05) samples.push_back({{2.03, y, z}, {-1, 0, 0}, 1e-3});
  }
  ASSERT_TRUE(volume.add(samples, SE3{}));
  ASSERT_TRUE(save_distance_field(folder / "a.vdb", volume, 1.5));

  openvdb::io::File file((folder / "a.vdb").string());
  file.open();
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("distance"));
  ASSERT_TRUE(grid);
  auto accessor = grid->getConstAccessor();
  const auto at = [&](double x) {
    return accessor.getValue(openvdb::Coord::round(grid->worldToIndex({x, 0.05, 0.05})));
  };
  EXPECT_NEAR(at(2.05), 0, 1e-6);  // middles of voxels
  EXPECT_NEAR(at(1.55), 0.5, 1e-6);
  EXPECT_NEAR(at(1.05), 1.0, 1e-6);
  EXPECT_NEAR(at(0.25), 1.5, 1e-6);  // the limit
  EXPECT_NEAR(grid->background(), 1.5, 1e-6);
  EXPECT_FALSE(accessor.isValueOn(openvdb::Coord(25, 0, 0)));  // behind it
}

}  // namespace
}  // namespace sgs::mesh
