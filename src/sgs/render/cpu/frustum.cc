// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/frustum.h"

#include <cmath>

namespace sgs::render::cpu {

Frustum::Frustum(const View<float>& view) {
  constexpr float m = kOutsideMargin;
  // Camera-frame normals of z > nearest, x > u_min z, x < u_max z, y > v_min z, y < v_max z.
  const float normals[5][3] = {{0, 0, 1},
                               {1, 0, -(view.u_min - m)},
                               {-1, 0, view.u_max + m},
                               {0, 1, -(view.v_min - m)},
                               {0, -1, view.v_max + m}};
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const float* n = normals[i];
    Plane& plane = planes_[i];
    for (int c = 0; c < 3; ++c) {
      plane.normal[c] = n[0] * view.R[c] + n[1] * view.R[3 + c] + n[2] * view.R[6 + c];
    }
    plane.offset = n[0] * view.t[0] + n[1] * view.t[1] + n[2] * view.t[2];
  }
  planes_[0].offset -= kNearest_m;
  origin_size_m_ = std::abs(view.t[0]) + std::abs(view.t[1]) + std::abs(view.t[2]);
}

bool Frustum::may_show(const map::MeanBounds::Box& box) const {
  constexpr float kRounding = 1e-5f;  // of coordinates in the world; far more than they need
  float center[3], half[3], size = origin_size_m_;
  for (int k = 0; k < 3; ++k) {
    center[k] = 0.5f * (box.low[k] + box.high[k]);
    half[k] = 0.5f * (box.high[k] - box.low[k]);
    size += std::abs(center[k]) + half[k];
  }
  bool inside = true;
  for (const Plane& plane : planes_) {
    // The box's largest value; of an empty box it is minus infinity or not a number.
    float most = plane.offset + kRounding * size;
    for (int k = 0; k < 3; ++k) {
      most += plane.normal[k] * center[k] + std::abs(plane.normal[k]) * half[k];
    }
    inside = inside && !(most < 0);
  }
  return inside;
}

}  // namespace sgs::render::cpu
