// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/synthetic/lens_rays.h"
#include "sgs/synthetic/ray_caster.h"
#include "sgs/synthetic/scene.h"
#include "sgs/synthetic/sensor_model.h"

namespace sgs::synthetic {

/// The infrared camera of a depth sensor that matches a projected pattern window by window, and the
/// table by which its driver brings depth into colour's pixels. Immutable after construction.
class Infrared {
 public:
  /// `color` is the colour camera behind its lens; `shift_px` is what the driver's table is wrong
  /// by. The small things of the scene and among the movers get materials, drawn from the seed.
  Infrared(const InfraredModel& model, const Scene& scene, std::span<const Primitive> movers,
           const LensCamera& color, const Eigen::Vector2d& shift_px, std::uint64_t seed);

  const PinholeCamera& camera() const { return camera_; }
  /// Maps points of the infrared camera into the colour camera: both look the same way.
  const SE3& T_color_infrared() const { return T_color_infrared_; }

  /// What the windows match of what the rays hit (with paint): nothing where too little light comes
  /// back or a mirror blinds, ragged silhouettes, and depths between both sides of some.
  RayImage matched(const RayImage& seen, std::int64_t frame, ThreadPool& pool) const;
  /// Depth in the colour camera's pixels behind its lens: each measurement goes to the whole pixel
  /// that is nearest, the nearer of two wins; single pixels left out on a surface repeat the one to
  /// their left.
  DepthImage registered(const DepthImage& depth) const;

 private:
  struct Material {
    float reflectance = 1;
    bool shiny = false;
  };
  struct Fields;
  bool too_dim(const RayImage& seen, std::size_t i, float limit) const;
  void match_row(const RayImage& seen, int y, const Fields& fields, std::uint64_t key,
                 RayImage& out) const;

  InfraredModel model_;
  LensCamera color_;
  PinholeCamera camera_;
  SE3 T_color_infrared_;
  Eigen::Vector2d shift_px_;
  std::uint64_t seed_;
  std::vector<Material> materials_;  // of the scene's primitives, then of the movers
};

}  // namespace sgs::synthetic
