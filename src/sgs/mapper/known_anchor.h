// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian.h"

namespace sgs::mapper {

/// Where a Gaussian of a finished map was born is not known: it is taken to lie on a surface, as
/// flat as it is itself, that was seen from `T_world_camera`, the place of `keyframe`.
map::Anchor known_anchor(const map::Gaussian& g, std::int32_t keyframe, const SE3& T_world_camera);

}  // namespace sgs::mapper
