// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "sgs/occupancy/grid.h"
#include "sgs/occupancy/volume.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

struct OccupancyOptions {
  double voxel_m = 0.05;
  double range_m = 4;     ///< surfaces farther away are left out
  bool from_map = false;  ///< depth drawn from the map at the keyframes, not the recording's
  std::optional<Eigen::Vector3d> up;      ///< against gravity, in the run's world; any length
  std::optional<double> camera_height_m;  ///< of the first camera over the floor
  int threads = 2;
};

/// What a run, or the runs of a map, saw of space, in its upright world.
struct RunOccupancy {
  explicit RunOccupancy(const occupancy::VolumeConfig& config) : volume(config) {}

  occupancy::OccupancyVolume volume;
  SE3 T_upright_world;
  std::optional<double> floor_m;  ///< z of the floor, where one was seen or is known
  int views = 0;
};

/// Goes through the depth along a run's path, of the recording or drawn from the map; of a map file
/// through that of its views. Errors: the recording is gone; nothing but the camera itself says
/// which way is up; no view has a pose; more voxels than memory may hold.
Result<RunOccupancy> occupancy_of(const std::filesystem::path& run_or_map,
                                  const OccupancyOptions& options);

/// The grid between two heights over the floor; an error where no floor was seen.
Result<occupancy::OccupancyGrid> grid_of_run(const RunOccupancy& occupancy,
                                             const occupancy::HeightBand& band);

}  // namespace sgs::run
