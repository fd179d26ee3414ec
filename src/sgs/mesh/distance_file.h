// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/core/error.h"
#include "sgs/occupancy/volume.h"

namespace sgs::mesh {

/// Writes how far each known place of a volume is from the nearest surface, as an OpenVDB grid of
/// floats named `distance`: metres, 0 in occupied voxels, at most `limit_m`, which is the
/// background, too. Active where something is known. A volume whose box does not fit memory is an
/// error, and nothing is written.
Status save_distance_field(const std::filesystem::path& path,
                           const occupancy::OccupancyVolume& volume, double limit_m);

}  // namespace sgs::mesh
