// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/camera/pinhole.h"

namespace sgs::synthetic {

/// The ray (x, y, 1) of each pixel of a picture behind a lens, in camera coordinates. Pixels that
/// see nothing, beyond the radius at which the lens' model folds back, have NaN. Immutable.
class LensRays {
 public:
  explicit LensRays(const LensCamera& camera);

  const LensCamera& camera() const { return camera_; }
  const float* x(int row) const { return x_.data() + index(row); }
  const float* y(int row) const { return y_.data() + index(row); }
  /// Pixel in which the point is seen, which lies in front of the camera.
  Eigen::Vector2f pixel(const Eigen::Vector3f& point) const {
    const Eigen::Vector2f xy = point.head<2>() / point.z();
    const Eigen::Vector2d bent = camera_.distortion.apply(xy.cast<double>());
    return {static_cast<float>(camera_.camera.fx * bent.x() + camera_.camera.cx),
            static_cast<float>(camera_.camera.fy * bent.y() + camera_.camera.cy)};
  }

 private:
  std::size_t index(int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(camera_.camera.width);
  }
  LensCamera camera_;
  std::vector<float> x_, y_;
};

}  // namespace sgs::synthetic
