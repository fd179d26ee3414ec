// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian.h"

namespace sgs::run {

/// A patch of a surface as a camera saw it.
struct Patch {
  Eigen::Vector3d normal;  ///< unit, towards the camera that saw it; world
  double area_m2 = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< its middle, world
};

/// The patches of a map: measured normals, with the areas of their Gaussians. A few that are far
/// larger than the others count as these, so that none decides alone.
std::vector<Patch> patches_of(const map::Snapshot& snapshot);
/// Adds those that a depth image shows, taken at `T_world_camera`: a few hundred, spread evenly
/// over it, none across an edge or nearly edge-on.
void add_patches(const PinholeCamera& camera, const DepthImage& depth, const SE3& T_world_camera,
                 std::vector<Patch>& patches);

/// Surfaces that lie level, seen from above: floors, tables, seats.
struct LevelSurfaces {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< their common normal
  double share = 0;                               ///< of the whole area, 0..1
};

/// The direction within `cone_deg` of `near` to which most of the area is normal; where the patches
/// of one plane lie far enough apart for it, the normal of that plane, which noise of single
/// normals does not turn. Empty where no direction stands out: a scene of no surface in particular
/// has about 1.5 % of its area within the ten degrees around any direction.
std::optional<LevelSurfaces> find_level_surfaces(const std::vector<Patch>& patches,
                                                 const Eigen::Vector3d& near, double cone_deg);

}  // namespace sgs::run
