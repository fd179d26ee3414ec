// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::synthetic {

/// What a trajectory looks at, sampled ten times a second: all that the layout of a scene needs to
/// know of it. World frame, z up, metres and seconds.
struct TrajectoryViews {
  std::vector<double> time;
  std::vector<Eigen::Vector3f> eye, forward;          ///< camera centre, optical axis (unit)
  std::vector<std::vector<Eigen::Vector3f>> corners;  ///< directions to the image corners

  TrajectoryViews(const Trajectory& trajectory, const PinholeCamera& camera);

  /// Box of the camera centres.
  Eigen::AlignedBox3f eyes() const;
  /// Mean horizontal viewing direction (unit); x where the views go all ways.
  Eigen::Vector3f heading() const;
  /// Box of what the corner rays hit of the plane z = 0 within `reach`, for times in [from, to].
  Eigen::AlignedBox2f floor_seen(float reach, double from, double to) const;
  /// Median of where the optical axes meet the plane z = `height`.
  Eigen::Vector2f centre_at(float height) const;
  /// Distance of `p` from the nearest camera centre.
  float clearance(const Eigen::Vector3f& p) const;
};

}  // namespace sgs::synthetic
