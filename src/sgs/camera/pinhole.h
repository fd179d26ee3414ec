// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "sgs/camera/distortion.h"
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

/// A pinhole camera behind a lens: how a camera delivers its images.
struct LensCamera {
  PinholeCamera camera;
  Distortion distortion;
  friend bool operator==(const LensCamera&, const LensCamera&) = default;
};

/// What a dataset must say about its camera.
struct Calibration {
  PinholeCamera camera;
  Distortion distortion;
  double depth_scale = 0;  ///< raw depth units per metre (TUM 5000, Replica 6553.5)
  friend bool operator==(const Calibration&, const Calibration&) = default;
};

}  // namespace sgs
