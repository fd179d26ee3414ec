// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/se3.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/map/gaussian.h"

namespace sgs::run {

/// Moves a map into another world, T_new_old: positions, orientations, and the colours that depend
/// on the view.
void move_into(const SE3& T_new_old, map::SplatMap& map);
/// The poses of cameras in another world.
Trajectory moved_into(const SE3& T_new_old, const Trajectory& poses);

}  // namespace sgs::run
