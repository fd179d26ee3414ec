// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "sgs/map/gaussian_store.h"
#include "sgs/mapper/keyframe.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// Depth image of a keyframe with its holes filled.
struct FilledDepth {
  DepthImage depth;              ///< metres, 0 only where a whole image has no measurement
  Image<std::uint8_t> borrowed;  ///< 1 where the depth is not measured here
};
/// Measured depth; pixels without take the farther of the nearest measurements left and right in
/// their row, rows without any take those above or below. `fill` false leaves the holes.
FilledDepth fill_depth(const KeyframePictures& pictures, bool fill);

/// What a sampled surface point contributes: shape of a Gaussian lying on it.
struct SurfacePoint {
  Eigen::Vector3f position;  ///< camera, metres
  Eigen::Vector3f normal;    ///< camera, unit, towards the camera
};

/// Cap of a Gaussian's largest log scale, `at_birth` its value then: growth by `max_growth`
/// (OptimizerConfig::max_growth), 0 = free.
inline float longest_log_scale(float at_birth, double max_growth) {
  return at_birth + (max_growth > 0 ? static_cast<float>(std::log(max_growth)) : 1e6f);
}

/// Adds Gaussians for a keyframe with an image quadtree (docs/mapping.md, section 2): leaves are as
/// large as colour and depth are flat; a leaf is used only where `rendering`, the present map seen
/// from the keyframe at full or half resolution, is not opaque or lies behind the measurement. Null
/// `rendering`: the map is empty. Returns how many were added: none where its view is gone.
std::size_t insert_quadtree(const MapKeyframe& keyframe, int keyframe_index,
                            const render::Rendering* rendering, const InsertionConfig& config,
                            double max_growth, map::GaussianStore& store);

/// Adds a Gaussian at every n-th pixel with depth, shaped by the covariance of its ten nearest
/// sampled neighbours and scaled by 1 / max(1, 2 z^1.5) (GS-ICP SLAM; docs/method.md, section 7).
std::size_t insert_grid(const MapKeyframe& keyframe, int keyframe_index,
                        const InsertionConfig& config, map::GaussianStore& store);

}  // namespace sgs::mapper
