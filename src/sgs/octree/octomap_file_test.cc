// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/octree/octomap_file.h"

#include <gmock/gmock.h>
#include <octomap/OcTree.h>

#include <vector>

#include "sgs/io/temporary_folder.h"

namespace sgs::octree {
namespace {

using occupancy::Cell;

/// A wall in front of a camera that looks along x.
occupancy::OccupancyVolume wall() {
  occupancy::OccupancyVolume volume({.voxel_m = 0.1, .range_m = 4, .min_views = 1});
  std::vector<occupancy::DepthSample> samples;
  for (double y = -1; y <= 1; y += 0.05) {
    for (double z = -1; z <= 1; z += 0.05) samples.push_back({{2.03, y, z}, {-1, 0, 0}, 1e-3});
  }
  EXPECT_TRUE(volume.add(samples, SE3{}));
  return volume;
}

// Every voxel is read back by OctoMap's own library as it was, and no others are.
TEST(OctomapFile, ReadsBack) {
  const io::TemporaryFolder folder;
  const auto volume = wall();
  ASSERT_TRUE(save_octomap(folder / "a.bt", volume));
  octomap::OcTree tree(0.5);
  ASSERT_TRUE(tree.readBinary((folder / "a.bt").string()));
  EXPECT_DOUBLE_EQ(tree.getResolution(), 0.1);
  std::size_t known = 0, wrong = 0, occupied = 0;
  volume.for_each([&](const Eigen::Vector3i& voxel, Cell cell) {
    const Eigen::Vector3d p = volume.voxel_m() * (voxel.cast<double>().array() + 0.5);
    const auto* node = tree.search(p.x(), p.y(), p.z());
    ++known;
    if (cell == Cell::kOccupied) ++occupied;
    if (node == nullptr || tree.isNodeOccupied(node) != (cell == Cell::kOccupied)) ++wrong;
  });
  EXPECT_GT(occupied, 300u);
  EXPECT_GT(known, 3 * occupied);
  EXPECT_EQ(wrong, 0u);
  tree.expand();
  EXPECT_EQ(tree.getNumLeafNodes(), known);
}

TEST(OctomapFile, BeyondTheTreeIsAnError) {
  const io::TemporaryFolder folder;
  occupancy::OccupancyVolume volume({.voxel_m = 0.1, .range_m = 4, .min_views = 1});
  SE3 far;
  far.t.x() = 3300;
  const occupancy::DepthSample sample{{0, 0, 2}, {0, 0, -1}, 1e-3};
  ASSERT_TRUE(volume.add({&sample, 1}, far));
  const Status status = save_octomap(folder / "a.bt", volume);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().remedy, ::testing::HasSubstr("--resolution"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bt"));
}

}  // namespace
}  // namespace sgs::octree
