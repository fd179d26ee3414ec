// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/free_space.h"

#include <algorithm>

#include "sgs/camera/depth_noise.h"

namespace sgs::registration {
namespace {

constexpr int kCell_px = 4;

/// Least measured depth of a cell, 0 where there is none.
float nearest_in(const DepthImage& depth, int column, int row) {
  float nearest = 0;
  for (int y = row * kCell_px; y < std::min(depth.height(), (row + 1) * kCell_px); ++y) {
    for (int x = column * kCell_px; x < std::min(depth.width(), (column + 1) * kCell_px); ++x) {
      const float z = depth(x, y);
      if (z > 0 && (nearest <= 0 || z < nearest)) nearest = z;
    }
  }
  return nearest;
}

}  // namespace

FreeSpace::FreeSpace(const DepthImage& depth, const PinholeCamera& camera)
    : width_((depth.width() + kCell_px - 1) / kCell_px),
      height_((depth.height() + kCell_px - 1) / kCell_px),
      fx_(static_cast<float>(camera.fx / kCell_px)),
      fy_(static_cast<float>(camera.fy / kCell_px)),
      cx_(static_cast<float>((camera.cx + 0.5) / kCell_px)),
      cy_(static_cast<float>((camera.cy + 0.5) / kCell_px)),
      nearest_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0f) {
  const auto index = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  };
  std::vector<float> cells(nearest_.size());
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      cells[index(column, row)] = nearest_in(depth, column, row);
    }
  }
  // The outermost cells stay 0: what lies beyond them was not seen.
  for (int row = 1; row + 1 < height_; ++row) {
    for (int column = 1; column + 1 < width_; ++column) {
      float nearest = cells[index(column, row)];
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          nearest = std::min(nearest, cells[index(column + dx, row + dy)]);
        }
      }
      nearest_[index(column, row)] = nearest;
    }
  }
}

bool FreeSpace::contains(const Eigen::Vector3f& point, float margin_m) const {
  constexpr float kSigmas = 3;
  if (!(point.z() > 0)) return false;
  const float inverse = 1 / point.z();
  const float u = point.x() * inverse * fx_ + cx_, v = point.y() * inverse * fy_ + cy_;
  // Written so that NaN fails.
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(width_) && v < static_cast<float>(height_))) {
    return false;
  }
  const float seen = nearest_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(u)];
  return seen > point.z() + margin_m + kSigmas * depth_sigma_m(seen);
}

}  // namespace sgs::registration
