// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mesh/distance_file.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <sstream>

#include "sgs/io/atomic_file.h"
#include "sgs/occupancy/distance.h"

namespace sgs::mesh {

Status save_distance_field(const std::filesystem::path& path,
                           const occupancy::OccupancyVolume& volume, double limit_m) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(static_cast<float>(limit_m));
  grid->setName("distance");
  const auto transform = openvdb::math::Transform::createLinearTransform(volume.voxel_m());
  // OpenVDB's voxels have their middles where ours have their lower corners.
  transform->postTranslate(openvdb::Vec3d(0.5 * volume.voxel_m()));
  grid->setTransform(transform);
  auto accessor = grid->getAccessor();
  SGS_RETURN_IF_ERROR(occupancy::for_each_distance(
      volume, limit_m, [&](const Eigen::Vector3i& voxel, double metres) {
        accessor.setValue({voxel.x(), voxel.y(), voxel.z()}, static_cast<float>(metres));
      }));
  std::ostringstream out;
  openvdb::io::Stream(out).write(openvdb::GridCPtrVec{grid});
  return io::write_file(path, out.str());
}

}  // namespace sgs::mesh
