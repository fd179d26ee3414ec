// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_occupancy.h"

#include <fmt/format.h>

#include "export_mesh.h"
#include "sgs/core/log.h"
#ifdef SGS_WITH_OCTOMAP
#include "sgs/octree/octomap_file.h"
#endif

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

Result<run::RunOccupancy> occupancy_of(const std::string& run, const OccupancyCommand& command) {
  run::OccupancyOptions options = command.options;
  if (!command.up.empty())
    options.up = Eigen::Vector3d(command.up[0], command.up[1], command.up[2]);
  if (command.camera_height_m > 0) options.camera_height_m = command.camera_height_m;
  SGS_ASSIGN_OR_RETURN(auto occupancy, run::occupancy_of(run, options));
  log().info("{} views; {}", occupancy.views,
             occupancy.floor_m ? fmt::format("the floor is at z = {:.3f} m", *occupancy.floor_m)
                               : "no floor was seen");
  return occupancy;
}

}  // namespace

void add_occupancy_options(CLI::App& command, OccupancyCommand& occupancy) {
  constexpr const char* kOf = "grid, octomap, esdf: ";
  command
      .add_option("--resolution", occupancy.options.voxel_m,
                  std::string(kOf) + "size of a cell in metres")
      ->check(CLI::Range(0.01, 1.0));
  command
      .add_option("--range", occupancy.options.range_m,
                  std::string(kOf) + "leave out surfaces farther from the camera, in metres")
      ->check(CLI::Range(0.5, 20.0));
  command
      .add_option("--heights", occupancy.heights_m,
                  "grid: LOW,HIGH over the floor in metres; what is between them is in the way "
                  "(default 0.1,1.5)")
      ->type_name("LOW,HIGH")
      ->delimiter(',')
      ->expected(2);
  command
      .add_option("--up", occupancy.up,
                  std::string(kOf) +
                      "where up is, in the axes of the first camera (x right, y "
                      "down, z forward), instead of what the run found out")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3);
  command
      .add_option("--camera-height", occupancy.camera_height_m,
                  "grid: of the first camera over the floor in metres, where no floor was seen")
      ->check(CLI::Range(0.01, 20.0));
  command.add_flag("--from-map", occupancy.options.from_map,
                   std::string(kOf) + "depth drawn from the map, not the recording's");
}

Status export_grid(const std::string& run, const OccupancyCommand& command, const fs::path& out) {
  occupancy::HeightBand band = command.band;
  if (!command.heights_m.empty()) band = {command.heights_m[0], command.heights_m[1]};
  if (!(band.low_m < band.high_m)) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--heights {},{}: the first must be the lower one", band.low_m, band.high_m));
  }
  SGS_ASSIGN_OR_RETURN(const auto occupancy, occupancy_of(run, command));
  SGS_ASSIGN_OR_RETURN(const auto grid, run::grid_of_run(occupancy, band));
  const fs::path yaml = out.extension() == ".yaml" ? out : out / "map.yaml";
  return occupancy::save_grid(
      yaml, grid,
      fmt::format(
          "Made by sgs: z up as in upright.toml; floor at {:.3f} m, in the way from {} to {} m "
          "over it",
          *occupancy.floor_m, band.low_m, band.high_m));
}

Status export_esdf(const std::string& run, const OccupancyCommand& command, const fs::path& out) {
  const run::OccupancyOptions& options = command.options;
  std::vector<std::string> arguments = {run,
                                        out.string(),
                                        "--distance",
                                        fmt::format("--resolution={}", options.voxel_m),
                                        fmt::format("--range={}", options.range_m),
                                        fmt::format("--threads={}", options.threads)};
  if (options.from_map) arguments.emplace_back("--from-map");
  if (!command.up.empty()) {
    arguments.push_back(fmt::format("--up={},{},{}", command.up[0], command.up[1], command.up[2]));
  }
  SGS_ASSIGN_OR_RETURN(
      auto program,
      start_mesh_program("distance fields",
                         "is there enough memory? A larger --resolution needs less", arguments));
  return program.finish();
}

Status export_octomap(const std::string& run, const OccupancyCommand& command,
                      const fs::path& out) {
#ifdef SGS_WITH_OCTOMAP
  SGS_ASSIGN_OR_RETURN(const auto occupancy, occupancy_of(run, command));
  return octree::save_octomap(out, occupancy.volume);
#else
  (void)run, (void)command;
  return fail(ErrorCode::kUnsupported, fmt::format("{}: this build has no OctoMap", out.string()),
              "install liboctomap-dev, then configure and build again");
#endif
}

}  // namespace sgs::app
