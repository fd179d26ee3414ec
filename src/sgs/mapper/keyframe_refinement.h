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
/// by `step` of the way. Without the pull towards 1 gains drift together (MAPPING, "Exposure").
/// `measured`, `rendered`: sums over well-exposed explained pixels (render::Gradients).
void update_gain(MapKeyframe& keyframe, const std::array<double, 3>& measured,
                 const std::array<double, 3>& rendered, double prior, double step);

/// Those sums for a keyframe that has no gradients yet, from a rendering of the map at its pose.
struct ExposureSums {
  std::array<double, 3> measured = {0, 0, 0}, rendered = {0, 0, 0};
};
ExposureSums exposure_sums(const MapKeyframe& keyframe, const render::Rendering& rendering);

/// One Adam step (0.8 / 0.99) of a keyframe's pose along d loss / d xi.
void refine_pose(MapKeyframe& keyframe, const Vector6d& gradient, double rate);

}  // namespace sgs::mapper
