// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "sgs/render/rasterizer.h"

/// Random little scenes for the tests of this module.
namespace sgs::render::testing {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Uniform in [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  float uniformf(double low, double high) { return static_cast<float>(uniform(low, high)); }

 private:
  std::mt19937_64 engine_;
};

inline PinholeCamera small_camera(int width, int height) {
  return {width, height, 0.9 * width, 0.93 * width, 0.5 * width - 0.7, 0.5 * height + 0.4};
}

inline SE3 tilted_pose() {
  Vector6d xi;
  xi << 0.1, -0.15, 0.2, 0.05, -0.1, 0.02;
  return SE3::exp(xi);
}

/// A Gaussian that the camera at `pose` sees around pixel (u, v) at depth z, about `sigma_px` wide.
inline map::Gaussian gaussian_at(const PinholeCamera& camera, const SE3& pose, double u, double v,
                                 double z, double sigma_px, Random& random) {
  map::Gaussian g{};
  const Eigen::Vector3d p = pose * camera.back_project(u, v, z);
  for (int i = 0; i < 3; ++i) {
    g.mean[i] = static_cast<float>(p[i]);
    g.log_scale[i] =
        static_cast<float>(std::log(sigma_px * z / camera.fx) + random.uniform(-0.7, 0.7));
    g.rgb[i] = random.uniformf(0, 1);
  }
  for (float& q : g.rotation) q = random.uniformf(-1, 1);
  g.opacity_logit = random.uniformf(-1, 2);
  return g;
}

inline std::vector<map::Gaussian> random_gaussians(const PinholeCamera& camera, const SE3& pose,
                                                   int count, double sigma_px, Random& random) {
  std::vector<map::Gaussian> out;
  for (int i = 0; i < count; ++i) {
    const double u = random.uniform(-0.05, 1.05) * camera.width;
    const double v = random.uniform(-0.05, 1.05) * camera.height;
    out.push_back(gaussian_at(camera, pose, u, v, random.uniform(0.6, 3.5), sigma_px, random));
  }
  return out;
}

/// A training view whose colours and depths lie well away from those of `rendering`, so that small
/// steps cross no kink of an L1 loss; some pixels have no depth.
inline TrainingImage training_image_beside(const Rendering& rendering, const PinholeCamera& camera,
                                           Random& random) {
  TrainingImage t{camera, Image<Rgbf>(camera.width, camera.height),
                  DepthImage(camera.width, camera.height)};
  const auto offset = [&] {
    return random.uniformf(0.05, 0.3) * (random.uniform(0, 1) < 0.5 ? -1.0f : 1.0f);
  };
  for (std::size_t i = 0; i < t.color.size(); ++i) {
    const Rgbf& c = rendering.color.data()[i];
    t.color.data()[i] = {c.r + offset(), c.g + offset(), c.b + offset()};
    const float alpha = rendering.alpha.data()[i], d = rendering.depth_sum.data()[i];
    const float z = alpha > 0.05f ? d / alpha : 1.5f;
    t.depth.data()[i] = random.uniform(0, 1) < 0.2 ? 0.0f : z * (1.0f + offset());
  }
  return t;
}

}  // namespace sgs::render::testing
