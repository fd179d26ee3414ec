// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/octree/octomap_file.h"

#include <octomap/OcTree.h>

#include <sstream>

#include "sgs/io/atomic_file.h"

namespace sgs::octree {

Status save_octomap(const std::filesystem::path& path, const occupancy::OccupancyVolume& volume) {
  constexpr int kMiddle = 1 << 15;  // of the tree's keys, 16 bits each
  octomap::OcTree tree(volume.voxel_m());
  const float free = tree.getClampingThresMinLog(), occupied = tree.getClampingThresMaxLog();
  bool fits = true;
  volume.for_each([&](const Eigen::Vector3i& voxel, occupancy::Cell cell) {
    const Eigen::Vector3i at = voxel.array() + kMiddle;
    if (at.minCoeff() < 0 || at.maxCoeff() >= 2 * kMiddle) {
      fits = false;
      return;
    }
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(at.x()),
                                 static_cast<octomap::key_type>(at.y()),
                                 static_cast<octomap::key_type>(at.z()));
    tree.setNodeValue(key, cell == occupancy::Cell::kFree ? free : occupied, true);
  });
  if (!fits) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: OctoMap's trees end {:.0f} m from the first camera", path.string(),
                            kMiddle * volume.voxel_m()),
                "a larger --resolution");
  }
  tree.updateInnerOccupancy();
  std::ostringstream out;
  if (!tree.writeBinary(out)) {
    return fail(ErrorCode::kInternal, fmt::format("{}: OctoMap could not write", path.string()));
  }
  return io::write_file(path, out.str());
}

}  // namespace sgs::octree
