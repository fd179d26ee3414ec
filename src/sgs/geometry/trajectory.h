// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// A pose at a time.
struct StampedPose {
  double timestamp_s = 0;
  SE3 T_world_camera;
};

/// Camera poses in strictly increasing time order.
class Trajectory {
 public:
  Trajectory() = default;
  /// Sorts by time; of poses with equal times the first is kept.
  explicit Trajectory(std::vector<StampedPose> poses);

  const std::vector<StampedPose>& poses() const { return poses_; }
  std::size_t size() const { return poses_.size(); }
  bool empty() const { return poses_.empty(); }
  /// Appends a pose; its time must be later than the last one's.
  void push_back(const StampedPose& pose);

  /// Pose at `timestamp_s`, interpolated between the two neighbours; empty outside the covered
  /// time or where the neighbours are more than `max_gap_s` apart. A pose within 1e-6 s is
  /// returned as it is.
  std::optional<SE3> at(double timestamp_s, double max_gap_s) const;

 private:
  std::vector<StampedPose> poses_;
};

/// Least-squares alignment of point sets: minimises sum |scale * R * source + t - target|^2.
struct Similarity {
  double scale = 1;
  SE3 T_target_source;
};
/// Horn / Umeyama closed form (Umeyama, PAMI 1991). `with_scale` false fixes scale at 1. Empty when
/// fewer than 1 pair is given; collinear or coincident points give one of the minimisers.
std::optional<Similarity> align_points(const std::vector<Eigen::Vector3d>& source,
                                       const std::vector<Eigen::Vector3d>& target, bool with_scale);

}  // namespace sgs
