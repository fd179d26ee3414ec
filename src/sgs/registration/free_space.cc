// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/free_space.h"

#include <algorithm>
#include <cmath>

namespace sgs::registration {

FreeSpace::FreeSpace(const SourceCloud& cloud, const PinholeCamera& camera, int step_px)
    : width_((camera.width + step_px - 1) / step_px),
      height_((camera.height + step_px - 1) / step_px),
      fx_(static_cast<float>(camera.fx / step_px)),
      fy_(static_cast<float>(camera.fy / step_px)),
      cx_(static_cast<float>((camera.cx + 0.5) / step_px)),
      cy_(static_cast<float>((camera.cy + 0.5) / step_px)),
      nearest_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0f),
      cover_({fx_, fy_, cx_, cy_, 0}, width_, height_) {
  constexpr float kSigmas = 3;
  const auto index = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  };
  std::vector<float> cells(nearest_.size(), 0.0f);
  for (const SourcePoint& p : cloud.points) {
    const int column = std::min(p.u / step_px, width_ - 1);
    const int row = std::min(p.v / step_px, height_ - 1);
    const float z = p.point.z() - kSigmas * std::sqrt(p.variance_m2);
    float& cell = cells[index(column, row)];
    if (cell <= 0 || z < cell) cell = z;
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
  cover_.draw(nearest_);
}

bool FreeSpace::contains(const Eigen::Vector3f& point, float margin_m) const {
  if (!(point.z() > 0)) return false;
  const float inverse = 1 / point.z();
  const float u = point.x() * inverse * fx_ + cx_, v = point.y() * inverse * fy_ + cy_;
  // Written so that NaN fails.
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(width_) && v < static_cast<float>(height_))) {
    return false;
  }
  const float seen = nearest_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(u)];
  return seen > point.z() + margin_m;
}

}  // namespace sgs::registration
