// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/camera_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sgs/core/stopwatch.h"

namespace sgs::run {
namespace {

/// Rotation that looks along `forward` with the image upright; `up` must not be parallel to it.
Eigen::Matrix3d looking(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  Eigen::Matrix3d R;
  R.col(2) = forward.normalized();
  R.col(0) = R.col(2).cross(up).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

Eigen::Vector3d median(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : points) values.push_back(p[k]);
    middle[k] = quantile(std::move(values), 0.5);
  }
  return middle;
}

/// A Gaussian as a disc: where it faces, times its area.
Eigen::Vector3d facing(const map::Gaussian& g) {
  const auto thinnest = std::min_element(g.log_scale, g.log_scale + 3) - g.log_scale;
  const Eigen::Quaternionf q(g.rotation[0], g.rotation[1], g.rotation[2], g.rotation[3]);
  float log_area = -g.log_scale[thinnest];
  for (const float s : g.log_scale) log_area += s;
  return std::exp(double{log_area}) *
         (q.normalized() * Eigen::Vector3f(Eigen::Vector3f::Unit(thinnest))).cast<double>();
}

}  // namespace

Eigen::Vector3d level_up(std::span<const map::Gaussian> gaussians, const Eigen::Vector3d& guess) {
  constexpr std::array kReach_deg = {40.0, 30.0, 20.0, 10.0, 5.0};  // mean shift, ever narrower
  constexpr double kLeastShare = 0.02;
  std::vector<Eigen::Vector3d> discs;
  double area = 0;
  for (const map::Gaussian& g : gaussians) {
    discs.push_back(facing(g));
    area += discs.back().norm();
  }
  Eigen::Vector3d up = guess;
  for (const double reach_deg : kReach_deg) {
    const double least = std::cos(reach_deg * std::numbers::pi / 180);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& disc : discs) {
      const double along = up.dot(disc);  // a disc has two sides
      if (std::abs(along) > least * disc.norm()) sum += along < 0 ? Eigen::Vector3d(-disc) : disc;
    }
    if (!(sum.norm() > kLeastShare * area)) return guess;
    up = sum.normalized();
  }
  return up;
}

std::vector<SE3> smooth_path(const Trajectory& trajectory, int count) {
  constexpr double kReach_s = 0.5;  // of the mean, to either side
  std::vector<SE3> views;
  const auto& poses = trajectory.poses();
  if (poses.empty()) return views;
  const double begin_s = poses.front().timestamp_s;
  const double length_s = poses.back().timestamp_s - begin_s;
  for (int i = 0; i < count; ++i) {
    const double time_s = begin_s + length_s * (count > 1 ? i / (count - 1.0) : 0.0);
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), forward = position, down = position;
    double sum = 0;
    for (const StampedPose& pose : poses) {
      const double weight = 1 - std::abs(pose.timestamp_s - time_s) / kReach_s;
      if (!(weight > 0)) continue;
      position += weight * pose.T_world_camera.t;
      forward += weight * pose.T_world_camera.R.col(2);
      down += weight * pose.T_world_camera.R.col(1);
      sum += weight;
    }
    // In a gap of the recording the last view stays.
    if (!(sum > 0)) {
      if (!views.empty()) views.push_back(views.back());
      continue;
    }
    views.emplace_back(looking(forward, -down), Eigen::Vector3d(position / sum));
  }
  return views;
}

std::vector<SE3> turntable(const Trajectory& trajectory, std::span<const map::Gaussian> gaussians,
                           const Eigen::Vector3d& up, int count) {
  if (trajectory.empty() || gaussians.empty()) return {};
  // Of a room that was walked through, the middle of the map; of a desk, the desk.
  std::vector<Eigen::Vector3d> points;
  for (const map::Gaussian& g : gaussians) points.emplace_back(g.mean[0], g.mean[1], g.mean[2]);
  const Eigen::Vector3d middle = median(points);
  std::vector<double> distances, heights;
  for (const StampedPose& pose : trajectory.poses()) {
    const Eigen::Vector3d from_middle = pose.T_world_camera.t - middle;
    heights.push_back(up.dot(from_middle));
    distances.push_back((from_middle - heights.back() * up).norm());
  }
  constexpr double kLeast_m = 0.1;
  const double radius = std::max(kLeast_m, quantile(distances, 0.5));
  const double height = quantile(heights, 0.5);
  const Eigen::Vector3d x = up.unitOrthogonal(), y = up.cross(x);
  std::vector<SE3> views;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    const Eigen::Vector3d offset =
        radius * (std::cos(angle) * x + std::sin(angle) * y) + height * up;
    views.emplace_back(looking(-offset, up), Eigen::Vector3d(middle + offset));
  }
  return views;
}

}  // namespace sgs::run
