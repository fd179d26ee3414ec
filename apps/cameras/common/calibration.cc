// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration.h"

#include <Eigen/Core>
#include <cmath>
#include <cstddef>

namespace sgs::cameras {

SE3 transform_of(std::span<const float, 9> rotation, std::span<const float, 3> translation,
                 Order order, double unit_m) {
  Eigen::Matrix3d R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int at = order == Order::kRows ? 3 * i + j : 3 * j + i;
      R(i, j) = static_cast<double>(rotation[static_cast<std::size_t>(at)]);
    }
  }
  const Eigen::Vector3d t = Eigen::Map<const Eigen::Vector3f>(translation.data()).cast<double>();
  return SE3(R, t * unit_m).normalized();
}

double units_per_metre(double unit_m) {
  constexpr double kRounding = 1e-5;
  const double units = 1 / unit_m;
  const double whole = std::round(units);
  return std::abs(units - whole) < kRounding * units ? whole : units;
}

void leave_out_equal_cameras(stream::Hello& hello) {
  const SE3& T = hello.T_color_depth;
  const bool same = hello.depth_camera == hello.color_camera && T.R.isIdentity(0) && T.t.isZero(0);
  if (same) hello.depth_camera.reset();
}

std::optional<std::size_t> nearest_mode(std::span<const SensorMode> modes,
                                        const capture::CameraMode& wanted, bool exactly) {
  std::optional<std::size_t> nearest;
  int least = 0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const SensorMode& mode = modes[i];
    const int apart = std::abs(mode.width - wanted.width) + std::abs(mode.height - wanted.height);
    if (mode.fps != wanted.fps || (exactly && apart > 0)) continue;
    if (nearest && apart >= least) continue;
    nearest = i;
    least = apart;
  }
  return nearest;
}

std::string packed_rows(const void* data, int width, int height, int stride_bytes,
                        int pixel_bytes) {
  std::string bytes;
  const int row_bytes = width * pixel_bytes;
  if (data == nullptr || width <= 0 || height <= 0 || stride_bytes < row_bytes) return bytes;
  bytes.reserve(static_cast<std::size_t>(row_bytes) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    bytes.append(static_cast<const char*>(data) + static_cast<std::ptrdiff_t>(stride_bytes) * y,
                 static_cast<std::size_t>(row_bytes));
  }
  return bytes;
}

std::string rgb_of_bgra(std::string bytes) {
  constexpr std::size_t kFrom = 4, kTo = 3;
  const std::size_t pixels = bytes.size() / kFrom;
  for (std::size_t i = 0; i < pixels; ++i) {
    const char b = bytes[kFrom * i], g = bytes[kFrom * i + 1], r = bytes[kFrom * i + 2];
    bytes[kTo * i] = r;
    bytes[kTo * i + 1] = g;
    bytes[kTo * i + 2] = b;
  }
  bytes.resize(kTo * pixels);
  return bytes;
}

}  // namespace sgs::cameras
