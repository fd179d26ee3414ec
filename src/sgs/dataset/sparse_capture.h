// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/geometry/trajectory.h"

namespace sgs::dataset {

/// Whether frames are single views rather than a video: half of the gaps between them exceed
/// 0.2 s, or, where poses are known, half of the steps exceed 15 cm or 10 degrees (for those that
/// come without times). Tracking follows a motion; it cannot follow jumps.
bool is_sparse(const std::vector<double>& times_s, const Trajectory& poses);

}  // namespace sgs::dataset
