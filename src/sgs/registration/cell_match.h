// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/registration/clouds.h"

namespace sgs::registration {

/// Targets in the order of an index image's cells, structure of arrays: three neighbouring cells
/// are one vector load per coordinate. The outermost cells stay empty.
class CellTargets {
 public:
  static constexpr float kEmpty =
      1e15f;  ///< as a coordinate: far from everything, its square finite

  CellTargets(int width, int height);
  void clear();
  void set(int cell, const Eigen::Vector3f& point, const Eigen::Vector3f& normal);

  int width() const { return width_; }
  int height() const { return height_; }
  const float* point(int axis) const { return arrays_[axis].data(); }
  const float* normal(int axis) const { return arrays_[3 + axis].data(); }

 private:
  int width_, height_;
  std::vector<float> arrays_[6];  // with a few floats more than cells, so that loads may overhang
};

/// How a camera looks onto the cells: pinhole parameters in cells, border included.
struct CellCamera {
  float fx = 1, fy = 1, cx = 0, cy = 0;
  float near_m = 0;
};

/// Cell that a camera-frame point falls into, -1 outside of the inner cells or before the near
/// plane.
inline int cell_of(const CellCamera& camera, int width, int height, const Eigen::Vector3f& p) {
  if (!(p.z() > camera.near_m)) return -1;
  const float inverse = 1 / p.z();
  const float u = p.x() * inverse * camera.fx + camera.cx;
  const float v = p.y() * inverse * camera.fy + camera.cy;
  // Written so that NaN fails.
  if (!(u >= 1 && v >= 1 && u < static_cast<float>(width - 1) &&
        v < static_cast<float>(height - 1))) {
    return -1;
  }
  return static_cast<int>(v) * width + static_cast<int>(u);
}

/// Surface points as structure of arrays.
struct PointArrays {
  const float* point[3] = {};
  const float* normal[3] = {};
  std::size_t count = 0;
};

/// cell_of() for each point, moved by (R, t), and its depth there; -1, too, where its normal does
/// not face the camera. Same bits for the same instruction set; `cells` and `depths` hold `count`
/// values.
void project_to_cells(const PointArrays& points, const CellCamera& camera, int width, int height,
                      const Eigen::Matrix3f& R, const Eigen::Vector3f& t, int* cells,
                      float* depths);

/// Gates between a source point and its target.
struct CellGates {
  float max_distance2 = 0;
  float min_cosine = -1;  ///< of the angle between the normals
};

/// Writes for each point, moved by (R, t), the cell of its nearest target in the 3x3 cells around
/// it, -1 where none passes the gates. Same bits for the same instruction set.
void match_cells(const CellTargets& targets, const CellCamera& camera, const CellGates& gates,
                 const Eigen::Matrix3f& R, const Eigen::Vector3f& t,
                 std::span<const SourcePoint> points, std::span<int> cells);

}  // namespace sgs::registration
