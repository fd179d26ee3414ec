// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>

#include "sgs/camera/rgbd_frame.h"

namespace sgs::mapper {

/// A coloured wall in the plane z = `wall_z_m` of the world, seen from `T`, as an RGB-D frame: what
/// the mapper's tests look at. The pattern is smooth and unique over metres.
inline std::shared_ptr<RgbdFrame> wall_frame(const PinholeCamera& camera, const SE3& T,
                                             std::int64_t index = 0, double wall_z_m = 2.0,
                                             double brightness = 1.0) {
  auto frame = std::make_shared<RgbdFrame>();
  frame->index = index;
  frame->timestamp_s = 0.1 * static_cast<double>(index);
  frame->camera = camera;
  frame->color = ColorImage(camera.width, camera.height);
  frame->depth = DepthImage(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = T.R * camera.back_project(u, v, 1.0);
      const double z = (wall_z_m - T.t.z()) / ray.z();
      if (!(z > 0)) continue;
      const Eigen::Vector3d p = T.t + z * ray;
      const auto value = [&](double a, double b, double c) {
        const double s = 0.5 + 0.2 * std::sin(a * p.x() + c) + 0.2 * std::sin(b * p.y() - c);
        return static_cast<std::uint8_t>(std::lround(255 * brightness * s));
      };
      frame->color(u, v) = {value(7, 5, 0), value(4, 9, 1), value(11, 3, 2)};
      frame->depth(u, v) = static_cast<float>(z);
    }
  }
  return frame;
}

inline PinholeCamera small_camera() { return {160, 120, 140, 140, 79.5, 59.5}; }

inline SE3 translated(double x, double y, double z) {
  return {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(x, y, z)};
}

}  // namespace sgs::mapper
