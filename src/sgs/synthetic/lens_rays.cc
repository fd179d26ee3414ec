// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/lens_rays.h"

#include <limits>

namespace sgs::synthetic {

LensRays::LensRays(const LensCamera& camera) : camera_(camera) {
  const PinholeCamera& c = camera.camera;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  x_.assign(index(c.height), kNone);
  y_ = x_;
  for (int v = 0; v < c.height; ++v)
    for (int u = 0; u < c.width; ++u) {
      const auto xy = camera.distortion.invert({(u - c.cx) / c.fx, (v - c.cy) / c.fy});
      if (!xy) continue;
      const std::size_t i = index(v) + static_cast<std::size_t>(u);
      x_[i] = static_cast<float>(xy->x());
      y_[i] = static_cast<float>(xy->y());
    }
}

}  // namespace sgs::synthetic
