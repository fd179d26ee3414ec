// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "sgs/mapper/keyframe.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// Moves a keyframe's gains towards those that explain its picture: per channel
///   g* = (sum y / sum r + prior) / (1 + prior),
/// by `step` of the way. Without the pull towards 1 gains drift together
/// (docs/mapping.md, section 6).
/// `measured`, `rendered`: sums over well-exposed explained pixels (render::Gradients).
void update_gain(MapKeyframe& keyframe, const std::array<double, 3>& measured,
                 const std::array<double, 3>& rendered, double prior, double step);

/// Those sums for a keyframe that has no gradients yet, from a rendering of the map at its pose.
struct ExposureSums {
  std::array<double, 3> measured = {0, 0, 0}, rendered = {0, 0, 0};
};
ExposureSums exposure_sums(const MapKeyframe& keyframe, const render::Rendering& rendering);

/// One Gauss-Newton step of a keyframe's pose: `config.pose_share` of the way to the minimum of the
/// loss, quadratic with keyframe.pose_information, plus
///   1/2 pixels (pose_prior_rotation |phi|^2 + pose_prior_translation |rho|^2),
///   [phi; rho] = log(T_odom_camera^-1 T_world_camera).
/// `gradient`: d loss / d xi summed over as many pixels as keyframe.pose_information is; `pixels`:
/// how many. A gradient that is not finite is passed over.
void refine_pose(MapKeyframe& keyframe, const Vector6d& gradient, double pixels,
                 const KeyframeRefinementConfig& config);

}  // namespace sgs::mapper
