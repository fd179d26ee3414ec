// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_refinement.h"

#include <algorithm>
#include <cmath>

namespace sgs::mapper {

void update_gain(MapKeyframe& keyframe, const std::array<double, 3>& measured,
                 const std::array<double, 3>& rendered, double prior, double step) {
  constexpr double kMinSum = 100, kMinGain = 0.5, kMaxGain = 2;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(rendered[c] > kMinSum)) continue;
    const double target =
        std::clamp((measured[c] / rendered[c] + prior) / (1 + prior), kMinGain, kMaxGain);
    keyframe.gain[c] += static_cast<float>(step * (target - static_cast<double>(keyframe.gain[c])));
  }
}

ExposureSums exposure_sums(const MapKeyframe& keyframe, const render::Rendering& rendering) {
  constexpr int kStep = 3;
  const int scale = rendering_scale(rendering, keyframe.camera());
  ExposureSums sums;
  for (int y = 0; y < keyframe.camera().height; y += kStep) {
    for (int x = 0; x < keyframe.camera().width; x += kStep) {
      const int u = std::min(x / scale, rendering.alpha.width() - 1);
      const int v = std::min(y / scale, rendering.alpha.height() - 1);
      if (rendering.alpha(u, v) <= 0.9f || keyframe.depth_m(x, y) <= 0) continue;
      const Rgb8& c = keyframe.color()(x, y);
      const render::Rgbf& r = rendering.color(u, v);
      const std::array<double, 3> measured = {c.r / 255.0, c.g / 255.0, c.b / 255.0};
      const std::array<double, 3> rendered = {r.r, r.g, r.b};
      for (std::size_t k = 0; k < 3; ++k) {
        if (measured[k] <= 0.02 || measured[k] >= 0.97) continue;
        sums.measured[k] += measured[k];
        sums.rendered[k] += rendered[k];
      }
    }
  }
  return sums;
}

void refine_pose(MapKeyframe& keyframe, const Vector6d& gradient, double rate) {
  constexpr double kBeta1 = 0.8, kBeta2 = 0.99, kEpsilon = 1e-12;
  if (!gradient.allFinite()) return;
  Vector6d& m = keyframe.pose_moment1;
  Vector6d& v = keyframe.pose_moment2;
  const int t = ++keyframe.pose_steps;
  m = kBeta1 * m + (1 - kBeta1) * gradient;
  v = kBeta2 * v + (1 - kBeta2) * gradient.cwiseAbs2();
  const Vector6d unbiased = m / (1 - std::pow(kBeta1, t));
  const Vector6d spread = (v / (1 - std::pow(kBeta2, t))).cwiseSqrt();
  const Vector6d step = rate * unbiased.cwiseQuotient(spread + Vector6d::Constant(kEpsilon));
  keyframe.T_world_camera = (keyframe.T_world_camera * SE3::exp(-step)).normalized();
}

}  // namespace sgs::mapper
