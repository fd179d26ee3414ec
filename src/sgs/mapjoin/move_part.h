// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sgs/mapjoin/part.h"

namespace sgs::mapjoin {

/// Views at other poses, and all that hangs on them: the places from where the map looks like them,
/// and each Gaussian with the view next to its birth. What lies twice where it is now is merged
/// (mapper::merge_layers()); returns how many Gaussians were.
std::size_t move_part(Part& part, std::vector<SE3> T_world_camera);

}  // namespace sgs::mapjoin
