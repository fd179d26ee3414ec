// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "sgs/core/error.h"
#include "sgs/occupancy/volume.h"

namespace sgs::occupancy {

/// Calls `visit(voxel, metres)` for each voxel that is not unknown, with how far its middle is from
/// the middle of the nearest occupied one: exact, also across what is unknown; 0 in those, and at
/// most `limit_m`. A volume whose box does not fit memory is an error.
Status for_each_distance(const OccupancyVolume& volume, double limit_m,
                         const std::function<void(const Eigen::Vector3i&, double)>& visit);

}  // namespace sgs::occupancy
