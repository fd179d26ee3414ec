// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "sgs/mapfile/map_file.h"

namespace sgs::mapjoin {

/// A map that is joined to others, or what others were joined to: in memory but for the pictures of
/// its views, which stay in their files and are asked for one by one.
struct Part {
  std::vector<mapfile::MapSession> sessions;
  mapfile::MapGaussians gaussians;  ///< without harmonics
  mapfile::MapGraph graph;          ///< with a place for every view
  std::vector<double> times_s;      ///< of each view, in its session
  std::vector<SE3> T_world_camera;  ///< of each view
  /// A view as its file has it, but at its pose above; from any thread.
  std::function<alignment::KnownView(std::size_t)> view;

  std::size_t views() const { return T_world_camera.size(); }
};

/// Reads a map and all that is in it; a map without views is refused.
Result<Part> load_part(const std::filesystem::path& path);

/// `part` with its views elsewhere: the pictures stay where they are.
void place_views(Part& part, std::vector<SE3> T_world_camera);

/// The view that each Gaussian is moved with (slam::views_of_gaussians()).
std::vector<std::int32_t> views_of_gaussians(const Part& part);

/// Both, `other` after `base`: sessions, views and edges of `other` are numbered on. Nothing moves,
/// and the worlds have nothing to do with each other yet.
Part side_by_side(const Part& base, const Part& other);

}  // namespace sgs::mapjoin
