// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "sgs/api/export.h"

namespace sgs::api {

/// How a lens bends what the pinhole would show.
enum class Lens {
  kBrown,    ///< Brown and Conrady: radial and tangential, OpenCV's usual model
  kFisheye,  ///< Kannala and Brandt: the angle as a polynomial; cv::fisheye, ROS's equidistant
};

/// A pinhole camera; pixel centres at integer coordinates.
struct Camera {
  int width = 0, height = 0;              ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  /// Of the lens, in OpenCV's order k1 k2 p1 p2 [k3 [k4 k5 k6]]: 0, 4, 5 or 8 numbers; k1 k2 k3 k4
  /// of a fisheye, or 0 numbers. Frames are rectified on their way in; cameras that the
  /// library hands out have none.
  std::vector<double> distortion;
  Lens lens = Lens::kBrown;
};

/// T_world_camera as a 4x4 matrix, row by row: it takes points of the camera (x right, y down, z
/// ahead; metres) into the world. Its last row is 0 0 0 1.
using Pose = std::array<double, 16>;

/// The pose of a camera that has not moved.
inline constexpr Pose kIdentityPose = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// Camera poses in rising order of time.
struct SGS_API Trajectory {
  std::vector<double> times;  ///< seconds
  std::vector<Pose> poses;    ///< as many as `times`

  std::size_t size() const { return times.size(); }
  /// Reads a TUM text file: rows `timestamp tx ty tz qx qy qz qw`.
  static Trajectory load(const std::string& path);
  /// Writes one, nine digits after the point. Throws where the poses are no rigid motions or the
  /// times do not rise.
  void save(const std::string& path) const;
};

/// Floats somewhere in memory, row by row; rows may lie further apart than they are long.
struct ArrayView {
  const float* data = nullptr;
  std::size_t rows = 0, columns = 0;
  std::ptrdiff_t row_stride = 0;  ///< bytes from one row to the next

  const float* row(std::size_t i) const {
    return reinterpret_cast<const float*>(reinterpret_cast<const char*>(data) +
                                          static_cast<std::ptrdiff_t>(i) * row_stride);
  }
};

/// Names and values as text, e.g. {{"depth_scale", "1000"}}.
using Settings = std::vector<std::pair<std::string, std::string>>;

}  // namespace sgs::api
