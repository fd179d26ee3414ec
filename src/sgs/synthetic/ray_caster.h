// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/synthetic/lens_rays.h"
#include "sgs/synthetic/scene.h"

namespace sgs::synthetic {

/// What the rays of an image hit. Row-major, one entry per pixel.
struct RayImage {
  int width = 0, height = 0;
  std::vector<float> depth;   ///< along the optical axis, metres, exact; 0 = nothing
  std::vector<float> cosine;  ///< between ray and surface normal
  /// Index of the primitive, those of the request's movers after the scene's; 0xffff = nothing.
  std::vector<std::uint16_t> surface;
  std::vector<Eigen::Array4f> color;  ///< 0..1 red green blue, sharp; empty unless asked for
  std::vector<float> paint;  ///< luma of the surface in any light, blurred; empty unless asked for
};

/// Which rays are cast, one per pixel, and what is wanted of what they hit.
struct RayRequest {
  PinholeCamera camera;
  std::vector<SE3> row_poses;  ///< T_world_camera of every row (rolling shutter), or a single one
  Eigen::Vector2d shift_px{0, 0};  ///< of the rays from the pixels' centres; not behind a lens
  const LensRays* lens = nullptr;  ///< the rays of `camera` behind a lens; none = straight ones
  /// Surfaces beside those of the scene, where they are at the image's time.
  std::span<const Primitive> movers = {};
  bool with_color = false;
  bool with_paint = false;
};

RayImage cast_rays(const Scene& scene, const RayRequest& request, ThreadPool& pool);

/// Softens the stairs at silhouettes: 3x3 means where the surface changes.
void smooth_silhouettes(RayImage& image, ThreadPool& pool);

}  // namespace sgs::synthetic
