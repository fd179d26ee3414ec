// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/trajectory_views.h"

#include <algorithm>
#include <cstddef>

namespace sgs::synthetic {

using Eigen::Vector2f;
using Eigen::Vector3f;

TrajectoryViews::TrajectoryViews(const Trajectory& trajectory, const PinholeCamera& camera) {
  double next = -1e300;
  for (const StampedPose& p : trajectory.poses()) {
    if (p.timestamp_s < next) continue;
    next = p.timestamp_s + 0.1;
    time.push_back(p.timestamp_s);
    eye.push_back(p.T_world_camera.t.cast<float>());
    forward.push_back(p.T_world_camera.R.col(2).cast<float>());
    corners.emplace_back();
    for (double u : {0.0, camera.width - 1.0})
      for (double v : {0.0, camera.height - 1.0})
        corners.back().push_back((p.T_world_camera.R * camera.back_project(u, v, 1)).cast<float>());
  }
}

Eigen::AlignedBox3f TrajectoryViews::eyes() const {
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : eye) box.extend(p);
  return box;
}

Vector3f TrajectoryViews::heading() const {
  Vector3f sum = Vector3f::Zero();
  for (const Vector3f& d : forward) sum += Vector3f(d.x(), d.y(), 0);
  return sum.norm() > 0.2f * float(forward.size()) ? sum.normalized().eval()
                                                   : Vector3f::UnitX().eval();
}

Eigen::AlignedBox2f TrajectoryViews::floor_seen(float reach, double from, double to) const {
  Eigen::AlignedBox2f box;
  for (std::size_t i = 0; i < eye.size(); ++i) {
    if (time[i] < from || time[i] > to) continue;
    box.extend(Vector2f(eye[i].head<2>()));
    for (const Vector3f& d : corners[i]) {
      const float s = d.z() < -1e-3f ? std::min(-eye[i].z() / d.z(), reach) : reach;
      box.extend(Vector2f((eye[i] + s * d).head<2>()));
    }
  }
  return box;
}

Vector2f TrajectoryViews::centre_at(float height) const {
  std::vector<float> x, y;
  for (std::size_t i = 0; i < eye.size(); ++i) {
    const float s = forward[i].z() < -0.05f ? (eye[i].z() - height) / -forward[i].z() : 1.5f;
    const Vector3f p = eye[i] + std::clamp(s, 0.2f, 3.f) * forward[i];
    x.push_back(p.x());
    y.push_back(p.y());
  }
  const auto middle = [](std::vector<float>& v) {
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  return {middle(x), middle(y)};
}

float TrajectoryViews::clearance(const Vector3f& p) const {
  float best = 1e9f;
  for (const Vector3f& e : eye) best = std::min(best, (e - p).norm());
  return best;
}

}  // namespace sgs::synthetic
