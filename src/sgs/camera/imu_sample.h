// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace sgs {

/// One measurement of an inertial unit, in the unit's own axes.
struct ImuSample {
  double timestamp_s = 0;
  /// What the unit feels: at rest against gravity, so upwards. m/s2, unless the recording says it
  /// otherwise.
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> angular_velocity_rad_s = {};  ///< where there is a gyroscope
};

}  // namespace sgs
