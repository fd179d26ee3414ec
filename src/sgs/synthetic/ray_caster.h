// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/synthetic/scene.h"

namespace sgs::synthetic {

/// What the rays of an image hit. Row-major, one entry per pixel.
struct RayImage {
  int width = 0, height = 0;
  std::vector<float> depth;            ///< along the optical axis, metres, exact; 0 = nothing
  std::vector<float> cosine;           ///< between ray and surface normal
  std::vector<std::uint16_t> surface;  ///< index of the primitive, 0xffff = nothing
  std::vector<Eigen::Array4f> color;   ///< 0..1 red green blue, sharp; empty unless asked for
};

/// Casts one ray per pixel centre, shifted by `shift_px`. `row_poses` holds T_world_camera of every
/// image row (rolling shutter) or a single pose.
RayImage cast_rays(const Scene& scene, const PinholeCamera& camera,
                   const std::vector<SE3>& row_poses, const Eigen::Vector2d& shift_px,
                   bool with_color, ThreadPool& pool);

/// Softens the stairs at silhouettes: 3x3 means where the surface changes.
void smooth_silhouettes(RayImage& image, ThreadPool& pool);

}  // namespace sgs::synthetic
