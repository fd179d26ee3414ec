// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/geometry/trajectory.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace sgs {

Trajectory::Trajectory(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  std::stable_sort(poses_.begin(), poses_.end(), [](const StampedPose& a, const StampedPose& b) {
    return a.timestamp_s < b.timestamp_s;
  });
  const auto last = std::unique(
      poses_.begin(), poses_.end(),
      [](const StampedPose& a, const StampedPose& b) { return a.timestamp_s == b.timestamp_s; });
  poses_.erase(last, poses_.end());
}

void Trajectory::push_back(const StampedPose& pose) {
  SGS_CHECK(poses_.empty() || pose.timestamp_s > poses_.back().timestamp_s,
            "trajectory times must increase");
  poses_.push_back(pose);
}

std::optional<SE3> Trajectory::at(double timestamp_s, double max_gap_s) const {
  constexpr double kSameTime_s = 1e-6;
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), timestamp_s,
                       [](const StampedPose& p, double time) { return p.timestamp_s < time; });
  if (after != poses_.end() && after->timestamp_s - timestamp_s <= kSameTime_s) {
    return after->T_world_camera;
  }
  if (after == poses_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (timestamp_s - before->timestamp_s <= kSameTime_s) return before->T_world_camera;
  if (after == poses_.end()) return std::nullopt;
  const double gap = after->timestamp_s - before->timestamp_s;
  if (!(gap <= max_gap_s)) return std::nullopt;
  return interpolate(before->T_world_camera, after->T_world_camera,
                     (timestamp_s - before->timestamp_s) / gap);
}

std::optional<Similarity> align_points(const std::vector<Eigen::Vector3d>& source,
                                       const std::vector<Eigen::Vector3d>& target,
                                       bool with_scale) {
  SGS_CHECK(source.size() == target.size(), "alignment needs pairs of points");
  if (source.empty()) return std::nullopt;
  const auto n = static_cast<double>(source.size());
  Eigen::Vector3d mean_source = Eigen::Vector3d::Zero(), mean_target = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    mean_source += source[i] / n;
    mean_target += target[i] / n;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    covariance += (target[i] - mean_target) * (source[i] - mean_source).transpose() / n;
    variance += (source[i] - mean_source).squaredNorm() / n;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) sign.z() = -1;
  Similarity result;
  result.T_target_source.R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  if (with_scale && variance > 0) {
    result.scale = svd.singularValues().dot(sign) / variance;
  }
  result.T_target_source.t = mean_target - result.scale * (result.T_target_source.R * mean_source);
  return result;
}

}  // namespace sgs
