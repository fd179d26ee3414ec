// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"

namespace sgs::registration {

/// The space that a depth image looks through, cell by cell: a surface that lies there is not where
/// it was taken to be, because it has moved or because the camera's pose has drifted since. (Space
/// carving by measured rays, as surfel maps remove what violates free space: Keller et al.,
/// Real-time 3D Reconstruction in Dynamic Scenes using Point-based Fusion, 3DV 2013, section 4.3.)
class FreeSpace {
 public:
  /// `depth` in metres, of the camera's size; 0 where nothing was measured.
  FreeSpace(const DepthImage& depth, const PinholeCamera& camera);

  /// Whether everything measured around the pixel of `point` (camera coordinates, metres) lies more
  /// than `margin_m` and three standard deviations of depth behind it. False where something around
  /// it was not measured: an edge or a thin thing may have been missed.
  bool contains(const Eigen::Vector3f& point, float margin_m) const;

 private:
  int width_, height_;
  float fx_, fy_, cx_, cy_;  // of the cells
  // Least depth of the 3x3 cells around each; 0 where one of them is without a measurement.
  std::vector<float> nearest_;
};

}  // namespace sgs::registration
