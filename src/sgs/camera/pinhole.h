// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs {

/// Pinhole camera without distortion; pixel centres at integer coordinates.
struct PinholeCamera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;

  /// Pixel of a point in camera coordinates (z > 0).
  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  /// Point at depth `z` metres on the ray of pixel (u, v).
  Eigen::Vector3d back_project(double u, double v, double z) const {
    return {(u - cx) / fx * z, (v - cy) / fy * z, z};
  }
  /// The camera of an image halved `level` times (2x2 means, odd edges dropped): a pixel c of the
  /// full image lies at (c + 0.5) / 2^level - 0.5.
  PinholeCamera halved(int level) const {
    const double s = 1.0 / (1 << level);
    return {width >> level, height >> level,      fx * s,
            fy * s,         (cx + 0.5) * s - 0.5, (cy + 0.5) * s - 0.5};
  }
  bool valid() const {
    return width > 0 && height > 0 && fx > 0 && fy > 0 && std::isfinite(fx) && std::isfinite(fy) &&
           std::isfinite(cx) && std::isfinite(cy);
  }
  friend bool operator==(const PinholeCamera&, const PinholeCamera&) = default;
};

/// Radial-tangential (Brown-Conrady) distortion in OpenCV's order k1 k2 p1 p2 k3.
struct Distortion {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  bool is_zero() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0; }
  /// Distorted normalised image coordinates of undistorted ones.
  Eigen::Vector2d apply(const Eigen::Vector2d& xy) const {
    const double x = xy.x(), y = xy.y(), r2 = x * x + y * y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  }
  friend bool operator==(const Distortion&, const Distortion&) = default;
};

/// What a dataset must say about its camera.
struct Calibration {
  PinholeCamera camera;
  Distortion distortion;
  double depth_scale = 0;  ///< raw depth units per metre (TUM 5000, Replica 6553.5)
  friend bool operator==(const Calibration&, const Calibration&) = default;
};

}  // namespace sgs
