// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sgs/dataset/imu.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::run {

/// Which way is up, as an accelerometer felt it along a path.
struct Gravity {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< unit, in the world of the path
  double scatter_deg = 0;                         ///< median angle of a single measurement to it
  std::size_t samples = 0;                        ///< that were taken while the path is known
};

/// Turns every acceleration into the world by the pose of its time and averages them robustly: what
/// the hand adds has no direction over a run, as the camera stays in the room. Where the unit's
/// mounting is not known, or the usual one fits markedly worse than another along a path that
/// turns, the one of the 24 ways to turn a box that leaves the directions closest together is
/// taken, of equal ones that whose up is nearest to `likely_up`. Accelerations in g or thousandths
/// of it are recognised by their length.
///
/// Empty where the samples cannot be used: none, another clock, no gravity in them. What was wrong
/// is added to `warnings`, each with the file or topic, the numbers and the remedy.
std::optional<Gravity> estimate_gravity(const dataset::ImuRecording& imu, const Trajectory& path,
                                        const Eigen::Vector3d& likely_up,
                                        std::vector<std::string>& warnings);

/// The direction that an accelerometer feels as up within the second around a time, in the camera's
/// axes of that time: enough to begin with, while the camera is held still. Empty where there is no
/// measurement, or the mounting is not known.
std::optional<Eigen::Vector3d> felt_up(const dataset::ImuRecording& imu, double time_s);

}  // namespace sgs::run
