// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian_set.h"
#include "sgs/map/gaussian_store.h"
#include "sgs/mapper/mapper_config.h"

namespace sgs::mapper {

/// A surface that was mapped twice, by keyframes that did not agree where it is, is two layers of
/// Gaussians, each nearly opaque. Once a correction has laid them on each other one is enough:
/// where two Gaussians of keyframes that moved differently (`moves[keyframe]`, already applied to
/// `store`) show the same piece of surface, the older takes the mean of both, weighted by opacity,
/// and the opacity of both one behind the other; the newer is put into `removed` (made anew, of all
/// of `store`) and has to be removed by the caller. Returns how many. Deterministic.
std::size_t merge_layers(std::span<const SE3> moves, const MergeConfig& config,
                         map::GaussianStore& store, map::GaussianSet& removed);

}  // namespace sgs::mapper
