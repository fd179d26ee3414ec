// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian.h"

namespace sgs::report {

/// What a map page shows beside the map.
struct MapPage {
  std::string title;
  std::vector<SE3> cameras;  ///< views to step through (T_world_camera); the first one opens
  PinholeCamera camera;      ///< of those views; not valid() = a default field of view
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< what dragging keeps upright
};

/// One HTML page that draws the Gaussians with WebGL 2: sorted, blended ellipses as in our
/// rasterizer, with orbit, pan and zoom. Everything is inside; it opens from disk. The Gaussians
/// must have passed io::check_splats().
std::string map_page_html(const map::SplatMap& map, const MapPage& page);
/// Checks the Gaussians and writes map_page_html() atomically.
Status save_map_page(const std::filesystem::path& path, const map::SplatMap& map,
                     const MapPage& page);

}  // namespace sgs::report
