// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "sgs/camera/depth_change.h"
#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian_store.h"

namespace sgs::mapper {

/// Moves each Gaussian rigidly with the keyframe that inserted it, `moves[keyframe]` in world
/// coordinates, and what the optimiser remembers of it along: the mean gradient of its position
/// turns; those of its rotation, and mean squares where the turn is more than a few degrees, begin
/// anew.
void move_gaussians(std::span<const SE3> moves, map::GaussianStore& store);

/// Moves each Gaussian along the ray of the keyframe that inserted it, to where the surface lies
/// now, and scales it with its distance.
void change_depth(std::span<const SE3> T_world_keyframe, const DepthChange& change,
                  map::GaussianStore& store);

}  // namespace sgs::mapper
