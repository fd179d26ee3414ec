// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_culling.h"

#include <algorithm>
#include <limits>

namespace sgs::mapper {

std::size_t most_redundant(const std::vector<MapKeyframe>& keyframes,
                           const std::vector<std::size_t>& active) {
  SGS_CHECK(active.size() > 1, "nothing is redundant beside nothing");
  const auto unlikeness = [&](std::size_t a, std::size_t b) {
    const MapKeyframe &first = keyframes[active[a]], &second = keyframes[active[b]];
    const SE3 &A = first.T_world_camera, &B = second.T_world_camera;
    const double depth = std::min(first.mean_depth_m(), second.mean_depth_m());
    // |A - B|^2 = 4 (1 - cos angle) of rotation matrices.
    return (A.t - B.t).squaredNorm() / (depth * depth) + (A.R - B.R).squaredNorm() / 2;
  };
  double least = std::numeric_limits<double>::infinity();
  std::size_t redundant = active.size() > 2 ? 1 : 0;
  for (std::size_t a = redundant; a + 1 < active.size(); ++a) {
    for (std::size_t b = a + 1; b < active.size(); ++b) {
      const double u = unlikeness(a, b);
      if (u >= least) continue;
      least = u;
      redundant = a;
    }
  }
  return active[redundant];
}

}  // namespace sgs::mapper
