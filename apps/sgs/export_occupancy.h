// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/export/occupancy_export.h"

namespace sgs::app {

/// What the formats that robots read are made with, as the command line says it.
struct OccupancyCommand {
  run::OccupancyOptions options;
  occupancy::HeightBand band;
  std::vector<double> up, heights_m;  ///< empty = not given
  double camera_height_m = 0;         ///< 0 = not given
};

/// --resolution, --heights, --range, --up, --camera-height, --from-map.
void add_occupancy_options(CLI::App& command, OccupancyCommand& occupancy);

/// The pair of map_server: `out` is its .yaml, or a folder for map.yaml and map.pgm.
Status export_grid(const std::string& run, const OccupancyCommand& command,
                   const std::filesystem::path& out);
/// Distances to the nearest surface as OpenVDB; sgs-mesh makes it, which may not be installed.
Status export_esdf(const std::string& run, const OccupancyCommand& command,
                   const std::filesystem::path& out);
/// OctoMap's binary tree; an error in a build without OctoMap.
Status export_octomap(const std::string& run, const OccupancyCommand& command,
                      const std::filesystem::path& out);

}  // namespace sgs::app
