// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "sgs/mapper/keyframe.h"

namespace sgs::mapper {

/// Which of the `active` keyframes (two or more, in order) is to go first: of the two that show
/// most alike, the older one, whose pose and exposure are from long ago. Never the very first one,
/// which fixes the map's place and exposure, unless there are only two. Alike is what moves the
/// picture least: the square of translation over mean depth plus that of the angle between both.
std::size_t most_redundant(const std::vector<MapKeyframe>& keyframes,
                           const std::vector<std::size_t>& active);

}  // namespace sgs::mapper
