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
  const auto pictures = keyframe.pictures();
  ExposureSums sums;
  if (!pictures) return sums;
  for (int y = 0; y < keyframe.camera().height; y += kStep) {
    for (int x = 0; x < keyframe.camera().width; x += kStep) {
      const int u = std::min(x / scale, rendering.alpha.width() - 1);
      const int v = std::min(y / scale, rendering.alpha.height() - 1);
      if (rendering.alpha(u, v) <= 0.9f || pictures->depth(x, y) <= 0) continue;
      const Rgb8& c = pictures->color()(x, y);
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

void refine_pose(MapKeyframe& keyframe, const Vector6d& gradient, double pixels,
                 const KeyframeRefinementConfig& config) {
  // The loss is far from quadratic over more than this.
  constexpr double kLongestStep = 5e-3;  // radians and metres
  if (!gradient.allFinite()) return;
  Vector6d prior;
  prior << Eigen::Vector3d::Constant(pixels * config.pose_prior_rotation),
      Eigen::Vector3d::Constant(pixels * config.pose_prior_translation);
  const Vector6d offset = (keyframe.T_odom_camera.inverse() * keyframe.T_world_camera).log();
  Matrix6d information =
      keyframe.pose_information ? *keyframe.pose_information : Matrix6d(Matrix6d::Zero());
  information.diagonal() += prior;
  // Keeps directions that nothing determines where they are.
  information.diagonal().array() += 1e-2 * pixels;
  Vector6d step =
      config.pose_share * information.ldlt().solve(gradient + prior.cwiseProduct(offset));
  if (!step.allFinite()) return;
  if (step.norm() > kLongestStep) step *= kLongestStep / step.norm();
  keyframe.T_world_camera = (keyframe.T_world_camera * SE3::exp(-step)).normalized();
}

}  // namespace sgs::mapper
