// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "sgs/backend/keyframe_archive.h"

namespace sgs::backend {

/// A corner of a room with a solid texture, seen by a camera that walks in front of it. What the
/// depth camera gets wrong is up to the test.
class TestRoom {
 public:
  /// Inverse depth as measured at a pixel, of the true one there.
  using Distortion = std::function<double(double u, double v, double inverse_depth)>;

  PinholeCamera camera{320, 240, 270, 270, 159.5, 119.5};
  Distortion distort = [](double, double, double q) { return q; };
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< of depth against colour
  double contrast = 40;
  double delay_s = 0;  ///< of depth after colour

  /// Pose of the k-th view: nearer and farther, to either side, turning.
  static SE3 pose(double k) {
    Vector6d xi;
    xi << 0.10 * std::sin(0.9 * k), 0.25 * std::sin(0.37 * k), 0.08 * std::sin(0.6 * k),
        0.5 * std::sin(0.31 * k), 0.2 * std::cos(0.53 * k), 0.6 * std::sin(0.22 * k);
    return SE3::exp(xi);
  }

  /// Camera twist per second at the k-th view, thirty of which there are in a second.
  static Vector6d velocity(int k) {
    constexpr double kStep = 0.01;
    return 15 / kStep * (pose(k - kStep).inverse() * pose(k + kStep)).log();
  }

  std::shared_ptr<RgbdFrame> view(int k) const {
    auto frame = std::make_shared<RgbdFrame>();
    frame->index = k;
    frame->timestamp_s = k / 30.0;
    frame->camera = camera;
    frame->color = ColorImage(camera.width, camera.height);
    frame->depth = DepthImage(camera.width, camera.height);
    const SE3 T = pose(k), T_depth = T * SE3::exp(delay_s * velocity(k));
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const double grey = texture(T * camera.back_project(u, v, depth(T, u, v)));
        const auto byte = static_cast<std::uint8_t>(std::lround(grey));
        frame->color(u, v) = {byte, byte, byte};
        const double q = 1 / depth(T_depth, u + shift_px.x(), v + shift_px.y());
        frame->depth(u, v) = static_cast<float>(1 / distort(u, v, q));
      }
    }
    return frame;
  }

  /// Where the k-th view is held to be: slightly wrong. `scale`: of the whole path.
  static SE3 tracked_pose(int k, double scale = 1) {
    Vector6d off;
    for (int i = 0; i < 6; ++i) off[i] = 0.001 * std::sin(12.9898 * (6 * k + i + 1));
    SE3 T = pose(k) * SE3::exp(off);
    T.t *= scale;
    return T;
  }
  static history::Path tracked_path(int n) {
    history::Path out;
    for (int k = 0; k < n; ++k) out.append({k, k / 30.0, tracked_pose(k)});
    return out;
  }

  /// Views 0 .. n-1 as keyframes.
  std::vector<Keyframe> keyframes(int n) const {
    std::vector<Keyframe> out;
    for (int k = 0; k < n; ++k) out.push_back(make_keyframe(*view(k), velocity(k), {}));
    return out;
  }

 private:
  /// Depth along the optical axis of the first of three walls that a ray meets.
  double depth(const SE3& T, double u, double v) const {
    const Eigen::Vector3d ray = T.R * camera.back_project(u, v, 1);
    const auto wall = [&](const Eigen::Vector3d& normal, double distance) {
      const double toward = normal.dot(ray);
      return toward > 1e-9 ? (distance - normal.dot(T.t)) / toward
                           : std::numeric_limits<double>::infinity();
    };
    return std::min({wall(Eigen::Vector3d(0.6, 0, 0.8), 2.0),
                     wall(Eigen::Vector3d(-0.7, 0, 0.714), 2.2),
                     wall(Eigen::Vector3d(0, 1, 0), 1.1)});
  }
  double texture(const Eigen::Vector3d& p) const {
    double sum = 0;
    for (int i = 1; i <= 12; ++i) {
      const double length = 0.07 + 0.02 * i;  // m
      const Eigen::Vector3d wave(std::sin(2.1 * i), std::sin(3.7 * i + 1), std::sin(5.3 * i + 2));
      sum += std::sin(2 * std::numbers::pi * wave.normalized().dot(p) / length + i);
    }
    return 128 + std::clamp(contrast * sum / 3, -127.0, 127.0);
  }
};

}  // namespace sgs::backend
