// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Frames of a papered wall for the tests of the visual trackers.

#include <cmath>
#include <cstdint>

#include "sgs/camera/rgbd_frame.h"

namespace sgs::alignment {

inline constexpr PinholeCamera kWallCamera{320, 240, 270, 268, 159.3, 121.1};
inline constexpr double kWallDistance_m = 1.5;

/// Grey of the wallpaper: tiles of 4 cm, each of its own brightness.
inline std::uint8_t wallpaper(double x, double y) {
  const auto column = static_cast<std::uint64_t>(std::floor(x / 0.04) + 1000);
  const auto row = static_cast<std::uint64_t>(std::floor(y / 0.04) + 1000);
  std::uint64_t h = (column * 2654435761ULL) ^ (row * 40503ULL * 65537ULL);
  h = (h ^ (h >> 15)) * 0x94d049bb133111ebULL;
  return static_cast<std::uint8_t>(30 + (h >> 40) % 200);
}

/// The wall z = 1.5 m as seen from a pose; plain grey unless `papered`.
inline RgbdFrame see_wall(const SE3& T_world_camera, int index, bool papered = true) {
  RgbdFrame frame;
  frame.index = index;
  frame.timestamp_s = index / 30.0;
  frame.camera = kWallCamera;
  frame.color = ColorImage(kWallCamera.width, kWallCamera.height);
  frame.depth = DepthImage(kWallCamera.width, kWallCamera.height);
  const int kSub = 3;  // samples per pixel and direction: corners must not jump from pixel to pixel
  for (int v = 0; v < kWallCamera.height; ++v) {
    for (int u = 0; u < kWallCamera.width; ++u) {
      double grey = 0, z = 0;
      for (int s = 0; s < kSub * kSub; ++s) {
        const double du = (s % kSub + 0.5) / kSub - 0.5, dv = (s / kSub + 0.5) / kSub - 0.5;
        const Eigen::Vector3d ray =
            T_world_camera.R * kWallCamera.back_project(u + du, v + dv, 1.0);
        const double distance = (kWallDistance_m - T_world_camera.t.z()) / ray.z();
        const Eigen::Vector3d p = T_world_camera.t + distance * ray;
        grey += papered ? wallpaper(p.x(), p.y()) : 128.0;
        z += distance;
      }
      const auto g = static_cast<std::uint8_t>(grey / (kSub * kSub) + 0.5);
      frame.color(u, v) = {g, g, g};
      frame.depth(u, v) = static_cast<float>(std::round(z / (kSub * kSub) * 5000) / 5000);
    }
  }
  return frame;
}

/// A pan along the wall with a little of everything else: about 8 mm per frame.
inline SE3 wall_pose(int index) {
  const double s = index / 30.0;
  return SE3(so3_exp({0.03 * std::sin(2 * s), 0.02 * std::sin(1.5 * s), 0.05 * std::sin(s)}),
             {0.24 * s, 0.05 * std::sin(1.2 * s), 0.05 * std::sin(0.9 * s)});
}

}  // namespace sgs::alignment
