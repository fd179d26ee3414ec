// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sgs/registration/cell_match.h"

namespace sgs::registration {

/// Depths of an index image, coarsely: tells as a whole what lies behind all of them. (The depth
/// pyramid of Greene, Kass, Miller: Hierarchical Z-Buffer Visibility, SIGGRAPH 1993.)
class CoverImage {
 public:
  /// `camera` looks onto width x height cells. Nothing is covered at first.
  CoverImage(const CellCamera& camera, int width, int height);

  /// `depths`: of the nearest surface in each cell, infinite where there is none. Where every
  /// second cell around has one, the others are taken for gaps between its points.
  void draw(std::span<const float> depths);
  /// Whether a sphere (camera coordinates, metres) lies more than `margin_m` behind all that was
  /// drawn before it and right beside it.
  bool covers(const Eigen::Vector3f& centre, float radius, float margin_m) const;

 private:
  static constexpr int kSide = 4;  // cells, of the squares of which the largest depth is kept

  CellCamera camera_;
  int width_, height_, columns_, rows_;
  std::vector<float> farthest_;  // of each square, infinite where it is open
  std::vector<int> filled_;      // cells of each square
};

}  // namespace sgs::registration
