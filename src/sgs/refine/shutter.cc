// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/shutter.h"

#include <algorithm>

namespace sgs::refine {

void shift_by_shutter(std::span<const map::Gaussian> gaussians, const PinholeCamera& camera,
                      const SE3& T_world_camera, const Vector6d& readout,
                      std::vector<map::Gaussian>& out, ThreadPool* pool) {
  constexpr std::size_t kChunkSize = 4096;
  constexpr float kLeastDepth_m = 0.05f, kLargestShare = 0.75f;
  out.resize(gaussians.size());
  const Eigen::Matrix3f R = T_world_camera.R.cast<float>();
  const Eigen::Vector3f t = T_world_camera.t.cast<float>();
  const Eigen::Vector3f turn = readout.head<3>().cast<float>(),
                        move = readout.tail<3>().cast<float>();
  const auto rows = static_cast<float>(camera.height);
  const auto fy = static_cast<float>(camera.fy);
  const auto middle = static_cast<float>(camera.cy) - 0.5f * (rows - 1);
  const auto shift = [&](int chunk, int) {
    const std::size_t first = static_cast<std::size_t>(chunk) * kChunkSize;
    const std::size_t end = std::min(first + kChunkSize, gaussians.size());
    for (std::size_t i = first; i < end; ++i) {
      out[i] = gaussians[i];
      const Eigen::Map<const Eigen::Vector3f> mean(gaussians[i].mean);
      const Eigen::Vector3f p = R.transpose() * (mean - t);
      if (!(p.z() > kLeastDepth_m)) continue;
      const float share =
          std::clamp((fy * p.y() / p.z() + middle) / rows, -kLargestShare, kLargestShare);
      const Eigen::Vector3f moved = mean - share * (R * (turn.cross(p) + move));
      std::copy_n(moved.data(), 3, out[i].mean);
    }
  };
  const auto chunks = static_cast<int>((gaussians.size() + kChunkSize - 1) / kChunkSize);
  if (pool != nullptr) {
    pool->run(chunks, shift);
  } else {
    for (int c = 0; c < chunks; ++c) shift(c, 0);
  }
}

Vector6d twist_at(const Trajectory& trajectory, double timestamp_s, double readout_s) {
  constexpr double kReach_s = 0.1;
  const auto& poses = trajectory.poses();
  const auto later = [](double time, const StampedPose& pose) { return time < pose.timestamp_s; };
  constexpr double kSameTime_s = 1e-6;
  const auto after = std::upper_bound(poses.begin(), poses.end(), timestamp_s + kSameTime_s, later);
  auto before = std::upper_bound(poses.begin(), poses.end(), timestamp_s - kSameTime_s, later);
  if (before == poses.begin() || after == poses.end()) return Vector6d::Zero();
  --before;
  const double interval_s = after->timestamp_s - before->timestamp_s;
  if (!(interval_s > 0) || interval_s > 2 * kReach_s) return Vector6d::Zero();
  return readout_s / interval_s * (before->T_world_camera.inverse() * after->T_world_camera).log();
}

}  // namespace sgs::refine
