// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "sgs/map/mean_bounds.h"
#include "sgs/render/view.h"

namespace sgs::render::cpu {

/// Where the means of visible Gaussians may lie: the planes behind the tests of project_chunk.
class Frustum {
 public:
  explicit Frustum(const View<float>& view);
  /// False when no mean in the box passes those tests, with room for their rounding.
  bool may_show(const map::MeanBounds::Box& box) const;

 private:
  struct Plane {
    float normal[3], offset;  ///< inside: normal . p + offset > 0, world
  };
  std::array<Plane, 5> planes_;
  float origin_size_m_;
};

}  // namespace sgs::render::cpu
