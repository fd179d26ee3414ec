// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/registration/clouds.h"
#include "sgs/registration/cover_image.h"
#include "sgs/registration/view_pyramid.h"

namespace sgs::registration {

/// The space that a frame looks through, cell by cell: a surface that lies there is not where it
/// was taken to be, because it has moved or because the camera's pose has drifted since. (Space
/// carving by measured rays, as surfel maps remove what violates free space: Keller et al.,
/// Real-time 3D Reconstruction in Dynamic Scenes using Point-based Fusion, 3DV 2013, section 4.3.)
class FreeSpace {
 public:
  /// `cloud`: points sampled from an image of the camera's size, one to `step_px` pixels.
  FreeSpace(const SourceCloud& cloud, const PinholeCamera& camera, int step_px);

  /// Whether all surface around the pixel of `point` (camera coordinates, metres) lies more than
  /// `margin_m` behind it. False where there is no surface around it: at an edge or beside a thin
  /// thing nothing is sampled.
  bool contains(const Eigen::Vector3f& point, float margin_m) const;
  /// Whether no point of a sphere is contained, whatever the margin; may say no where none is.
  bool misses(const Eigen::Vector3f& centre, float radius) const {
    return cover_.covers(centre, radius, 0);
  }
  /// Outside of it contains() is false.
  ViewPyramid view() const {
    return {{fx_, fy_}, {cx_, cy_}, {0, 0}, Eigen::Array2i(width_, height_).cast<float>()};
  }

 private:
  int width_, height_;
  float fx_, fy_, cx_, cy_;  // of the cells
  // Least depth of the 3x3 cells around each, three standard deviations of it taken off; 0 where
  // one of them is without a point.
  std::vector<float> nearest_;
  CoverImage cover_;  // of those
};

}  // namespace sgs::registration
