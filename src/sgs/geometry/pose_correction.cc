// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/geometry/pose_correction.h"

#include <algorithm>

#include "sgs/core/error.h"

namespace sgs {
namespace {

// What is moved now is what the next correction moves from: unless it is a rotation again each
// time, its rounding errors double with every correction, and after fifty of them they are metres.
SE3 moved(const MovedPose& pose, const SE3& T_world_camera) {
  return (pose.after * pose.before.inverse() * T_world_camera).normalized();
}

}  // namespace

PoseCorrection::PoseCorrection(std::vector<MovedPose> poses) : poses_(std::move(poses)) {
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    SGS_CHECK(poses_[i - 1].timestamp_s < poses_[i].timestamp_s, "poses come in time order");
  }
}

SE3 PoseCorrection::corrected(const SE3& T_world_camera, double timestamp_s) const {
  if (poses_.empty()) return T_world_camera;
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), timestamp_s,
                       [](const MovedPose& p, double time) { return p.timestamp_s < time; });
  if (after == poses_.begin()) return moved(poses_.front(), T_world_camera);
  if (after == poses_.end()) return moved(poses_.back(), T_world_camera);
  const MovedPose& before = *std::prev(after);
  const double alpha =
      (timestamp_s - before.timestamp_s) / (after->timestamp_s - before.timestamp_s);
  // Interpolating the corrected poses instead of the corrections keeps the result independent of
  // where the world's origin lies.
  return interpolate(moved(before, T_world_camera), moved(*after, T_world_camera), alpha);
}

double PoseCorrection::largest_translation_m() const {
  double largest = 0;
  for (const MovedPose& p : poses_) largest = std::max(largest, (p.after.t - p.before.t).norm());
  return largest;
}

double PoseCorrection::largest_rotation_rad() const {
  double largest = 0;
  for (const MovedPose& p : poses_) {
    largest = std::max(largest, (p.before.inverse() * p.after).angle());
  }
  return largest;
}

}  // namespace sgs
