// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/known_anchor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sgs::mapper {

map::Anchor known_anchor(const map::Gaussian& g, std::int32_t keyframe, const SE3& T_world_camera) {
  const auto thinnest = std::min_element(g.log_scale, g.log_scale + 3) - g.log_scale;
  map::Anchor anchor;
  anchor.point = {g.mean[0], g.mean[1], g.mean[2]};
  const Eigen::Quaternionf turn(g.rotation[0], g.rotation[1], g.rotation[2], g.rotation[3]);
  anchor.normal = turn.normalized().toRotationMatrix().col(thinnest);
  if (anchor.normal.dot(T_world_camera.t.cast<float>() - anchor.point) < 0) {
    anchor.normal = -anchor.normal;
  }
  anchor.sigma_n_m = std::exp(g.log_scale[thinnest]);
  anchor.keyframe = keyframe;
  return anchor;
}

}  // namespace sgs::mapper
