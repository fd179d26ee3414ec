// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/geometry/trajectory.h"
#include "sgs/map/gaussian.h"

namespace sgs::run {

/// Views along the way that the camera took, `count` of them spread evenly over its time, with the
/// shake of the hand taken out: each is a mean of the poses around it. Empty without poses.
std::vector<SE3> smooth_path(const Trajectory& trajectory, int count);

/// Upwards by the level surfaces of the map: the direction near `guess` (a unit vector, right to
/// some 35 degrees) that most of the area of the Gaussians' discs faces. `guess` where hardly any
/// does.
Eigen::Vector3d level_up(std::span<const map::Gaussian> gaussians, const Eigen::Vector3d& guess);

/// Views from a level circle about the middle of what the camera looked at, once around, looking at
/// the middle: as far away as the camera was in the median. `up` is a unit vector. What is seen is
/// taken from `gaussians`, means of which say where the map is. Empty without poses or Gaussians.
std::vector<SE3> turntable(const Trajectory& trajectory, std::span<const map::Gaussian> gaussians,
                           const Eigen::Vector3d& up, int count);

}  // namespace sgs::run
