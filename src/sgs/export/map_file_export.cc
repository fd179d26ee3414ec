// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/map_file_export.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "sgs/io/ply.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

namespace fs = std::filesystem;

Result<map::SplatMap> load_any_map(const fs::path& path) {
  std::error_code unreadable;
  if (fs::is_directory(path, unreadable)) return load_run_map(path);
  if (!mapfile::looks_like_map(path)) return io::load_splats(path);
  SGS_ASSIGN_OR_RETURN(const auto map, mapfile::MapFile::open(path));
  SGS_ASSIGN_OR_RETURN(auto gaussians, map.gaussians());
  return std::move(gaussians.splats);
}

Result<Upright> upright_of_map(const mapfile::MapFile& map) {
  std::vector<StampedPose> poses;
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < map.views(); ++i) {
    SGS_ASSIGN_OR_RETURN(const auto view, map.view(i));
    // Sessions of a map may overlap in time; what matters is the order.
    poses.push_back({static_cast<double>(i), view.T_world_camera});
    add_patches(view.frame.camera, view.frame.depth, view.T_world_camera, patches);
  }
  constexpr std::size_t kMost = 20000;
  const std::size_t step = 1 + patches.size() / kMost;
  for (std::size_t i = 0; i * step < patches.size(); ++i) patches[i] = patches[i * step];
  patches.resize((patches.size() + step - 1) / step);
  std::vector<std::string> warnings;
  const auto upright = find_upright({}, Trajectory(std::move(poses)), patches, warnings);
  if (upright) return *upright;
  return fail(ErrorCode::kNotFound, fmt::format("{}: the map has no view", map.path().string()),
              "without --upright, or with --up X,Y,Z");
}

Result<SE3> load_any_upright(const fs::path& path) {
  if (!mapfile::looks_like_map(path)) return load_run_upright(path);
  SGS_ASSIGN_OR_RETURN(const auto map, mapfile::MapFile::open(path));
  SGS_ASSIGN_OR_RETURN(const auto upright, upright_of_map(map));
  return upright.T_upright_world;
}

}  // namespace sgs::run
