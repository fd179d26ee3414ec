// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/api/types.h"
#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::api::internal {

Camera to_api(const PinholeCamera& camera);
Pose to_api(const SE3& T);
Trajectory to_api(const sgs::Trajectory& trajectory);

/// A camera from outside; refuses sizes, focal lengths and coefficients that cannot be.
Result<LensCamera> from_api(const Camera& camera);
/// A pose from outside; refuses matrices that are no rigid motion.
Result<SE3> from_api(const Pose& pose);
/// Refuses times that are not finite or do not rise, too.
Result<sgs::Trajectory> from_api(const Trajectory& trajectory);

}  // namespace sgs::api::internal
