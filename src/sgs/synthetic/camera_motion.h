// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/trajectory.h"
#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

/// The motion of a camera that, at the times of `motion`, is held where it is in the middle of
/// `whole`, or turned to and fro there.
Trajectory moved_otherwise(const Trajectory& motion, const Trajectory& whole, CameraMotion how);

}  // namespace sgs::synthetic
