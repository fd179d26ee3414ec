// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/map/gaussian.h"

namespace sgs::refine {

/// The Gaussians where a global shutter would have to see them to get the picture of a rolling one:
/// row v is read at (v / height - 1/2) of the readout, during which the camera moves by the twist
/// `readout` (rotation first) about its pose at the middle row, T_world_camera. Means move, to
/// first order in the twist; shapes stay. Same order and number; a gradient of a row of `out` is,
/// up to the twist, one of the Gaussian. `pool` may be null.
void shift_by_shutter(std::span<const map::Gaussian> gaussians, const PinholeCamera& camera,
                      const SE3& T_world_camera, const Vector6d& readout,
                      std::vector<map::Gaussian>& out, ThreadPool* pool);

/// How a camera on that path moves during `readout_s` about a time, rotation first; zero where the
/// path says nothing within 0.1 s to either side.
Vector6d twist_at(const Trajectory& trajectory, double timestamp_s, double readout_s);

}  // namespace sgs::refine
