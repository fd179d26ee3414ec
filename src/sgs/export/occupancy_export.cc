// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/occupancy_export.h"

#include <fmt/format.h>

#include "sgs/export/map_file_export.h"
#include "sgs/export/scene_export.h"
#include "sgs/occupancy/floor.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

SE3 first_pose(const Run& run) {
  return run.trajectory.empty() ? SE3{} : run.trajectory.poses().front().T_world_camera;
}

/// Which way is up: as asked for, else as more than the camera tells. `found` is what the run found
/// out, or what the map shows.
Result<SE3> turn_of(const std::optional<Upright>& found, const SE3& first, const fs::path& path,
                    const OccupancyOptions& options) {
  if (options.up) {
    if (!(options.up->norm() > 0) || !options.up->allFinite()) {
      return fail(ErrorCode::kInvalidArgument, "--up is no direction",
                  "three numbers that are not all zero, for example --up 0,-1,0");
    }
    return upright_turn(options.up->normalized(), first.R);
  }
  if (found && found->by != UprightBy::kCamera) return found->T_upright_world;
  return fail(ErrorCode::kNotFound,
              fmt::format("{}: which way is up is not known: {}", path.string(),
                          found ? "there was no accelerometer, and no floor was seen"
                                : "the run has not ended, or is of an older version"),
              "say it: --up X,Y,Z in the axes of the first camera (x right, y down, z forward); "
              "--up 0,-1,0 if it stood level");
}

/// Takes what views show. Views from nearly where the last one was are left out: they are many, and
/// their noise is much the same.
class Collector {
 public:
  Collector(RunOccupancy& into, const OccupancyOptions& options) : into_(into), options_(options) {}

  Status see(const PinholeCamera& camera, const SE3& T_world_camera, const DepthImage& depth) {
    constexpr double kMoved_m = 0.05, kTurned = 0.05;  // radians
    const SE3 T = into_.T_upright_world * T_world_camera;
    if (last_ && (T.t - last_->t).norm() < kMoved_m &&
        (last_->inverse() * T).quaternion().vec().norm() < kTurned / 2) {
      return {};
    }
    last_ = T;
    const int stride = occupancy::stride_for(camera, options_.voxel_m, options_.range_m);
    const auto samples = occupancy::sample_depth(camera, depth, stride);
    floor_.add(samples, T, options_.range_m);
    ++into_.views;
    if (into_.volume.add(samples, T)) return {};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("more voxels of {} m than fit memory", options_.voxel_m),
                "a larger --resolution, or a smaller --range");
  }
  std::optional<double> floor_m() const { return floor_.height_m(); }

 private:
  RunOccupancy& into_;
  const OccupancyOptions& options_;
  occupancy::FloorFinder floor_;
  std::optional<SE3> last_;
};

/// The recording's depth at the poses of its frames.
Status see_recording(const Run& run, Collector& collector) {
  auto input = reopen_input(run.input, 1, run.calibration);
  if (!input) {
    Error error = input.error();
    error.remedy = "bring the recording back, or take the depth from the map: --from-map";
    return tl::unexpected(error);
  }
  RgbdFrame frame;
  Error error;
  while (true) {
    const auto status = input->source->next(frame, error);
    if (status == dataset::FrameRead::kEnd) return {};
    if (status != dataset::FrameRead::kOk) continue;
    if (const auto pose = run.trajectory.at(frame.timestamp_s, 0.0)) {
      SGS_RETURN_IF_ERROR(collector.see(frame.camera, *pose, frame.depth));
    }
  }
}

/// `first`: pose of the first camera.
Result<RunOccupancy> completed(RunOccupancy occupancy, const Collector& collector,
                               const OccupancyOptions& options, const SE3& first) {
  occupancy.floor_m = collector.floor_m();
  if (options.camera_height_m) {
    occupancy.floor_m = (occupancy.T_upright_world * first.t).z() - *options.camera_height_m;
  }
  return occupancy;
}

Result<RunOccupancy> occupancy_of_map(const fs::path& path, const OccupancyOptions& options) {
  if (options.from_map) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: a map file keeps the depth that its views measured", path.string()),
        "leave --from-map out");
  }
  SGS_ASSIGN_OR_RETURN(const auto map, mapfile::MapFile::open(path));
  std::optional<Upright> found;
  if (!options.up) {
    SGS_ASSIGN_OR_RETURN(found, upright_of_map(map));
  }
  RunOccupancy occupancy({.voxel_m = options.voxel_m, .range_m = options.range_m});
  Collector collector(occupancy, options);
  SE3 first;
  for (std::size_t i = 0; i < map.views(); ++i) {
    SGS_ASSIGN_OR_RETURN(const auto view, map.view(i));
    if (i == 0) {
      first = view.T_world_camera;
      SGS_ASSIGN_OR_RETURN(occupancy.T_upright_world, turn_of(found, first, path, options));
    }
    SGS_RETURN_IF_ERROR(collector.see(view.frame.camera, view.T_world_camera, view.frame.depth));
  }
  if (occupancy.views == 0) {
    return fail(ErrorCode::kNotFound, fmt::format("{}: the map has no view", path.string()),
                "give a map that a run with loops has written");
  }
  return completed(std::move(occupancy), collector, options, first);
}

Result<RunOccupancy> occupancy_of_run(const fs::path& folder, const OccupancyOptions& options) {
  SGS_ASSIGN_OR_RETURN(const Run run, load_run(folder, kCamera | kTrajectory));
  RunOccupancy occupancy({.voxel_m = options.voxel_m, .range_m = options.range_m});
  SGS_ASSIGN_OR_RETURN(occupancy.T_upright_world,
                       turn_of(run.upright, first_pose(run), folder, options));
  Collector collector(occupancy, options);
  if (options.from_map) {
    SGS_ASSIGN_OR_RETURN(const auto map, load_run_map(folder));
    SGS_RETURN_IF_ERROR(
        for_each_keyframe(folder, map, ViewSource::kMap, options.threads,
                          [&](const PinholeCamera& camera, const KeyframeView& view) {
                            return collector.see(camera, view.T_world_camera, view.depth);
                          }));
  } else {
    SGS_RETURN_IF_ERROR(see_recording(run, collector));
  }
  if (occupancy.views == 0) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: no frame of the input has a pose", folder.string()),
                "has the input changed since the run?");
  }
  return completed(std::move(occupancy), collector, options, first_pose(run));
}

}  // namespace

Result<RunOccupancy> occupancy_of(const fs::path& run_or_map, const OccupancyOptions& options) {
  return mapfile::looks_like_map(run_or_map) ? occupancy_of_map(run_or_map, options)
                                             : occupancy_of_run(run_or_map, options);
}

Result<occupancy::OccupancyGrid> grid_of_run(const RunOccupancy& occupancy,
                                             const occupancy::HeightBand& band) {
  if (!occupancy.floor_m) {
    return fail(ErrorCode::kNotFound, "no floor was seen: heights over it are not known",
                "say how high the first camera was over the floor: --camera-height METRES");
  }
  return occupancy::make_grid(occupancy.volume, *occupancy.floor_m, band);
}

}  // namespace sgs::run
