// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/core/error.h"
#include "sgs/occupancy/volume.h"

namespace sgs::octree {

/// Writes a volume as OctoMap's binary tree (.bt): voxels are free, occupied or, where they are
/// missing, unknown; eight alike are one. A volume beyond 32768 voxels from its origin, which the
/// format cannot hold, is an error, and nothing is written.
Status save_octomap(const std::filesystem::path& path, const occupancy::OccupancyVolume& volume);

}  // namespace sgs::octree
