// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-mesh: what `sgs export RUN mesh` and `esdf` start. A program of its own, because OpenVDB is
// heavier than everything else together. What went wrong goes to standard output, message and
// remedy on a line each; `sgs` says it.
#include <CLI/CLI.hpp>
#include <csignal>
#include <string>

#include "helper_end.h"
#include "sgs/export/occupancy_export.h"
#include "sgs/export/scene_export.h"
#include "sgs/io/ply.h"
#include "sgs/mesh/depth_fusion.h"
#include "sgs/mesh/distance_file.h"
#include "sgs/runfolder/run.h"

namespace {

using namespace sgs;

/// Coloured mesh of the depth seen from the keyframes, as PLY.
struct MeshCommand {
  std::string run, output;
  double voxel_m = 0.015;
  bool measured = false;  ///< fuse the camera's depth instead of the map's
  bool upright = false;   ///< in the world turned upright
  int threads = 2;

  bool distance = false;  ///< a distance field instead of a mesh
  double limit_m = 2;     ///< beyond which distances are not told apart
  run::OccupancyOptions occupancy;
  std::vector<double> up;  ///< empty = as the run found out
};

Result<map::SplatMap> load_map(const std::string& run) {
  std::error_code error;
  return std::filesystem::is_directory(run, error) ? run::load_run_map(run) : io::load_splats(run);
}

Status make_mesh(const MeshCommand& command) {
  SGS_ASSIGN_OR_RETURN(const auto map, load_map(command.run));
  mesh::DepthFusionConfig config;
  config.voxel_m = command.voxel_m;
  mesh::DepthFusion fusion(config);
  SGS_RETURN_IF_ERROR(run::for_each_keyframe(
      command.run, map, command.measured ? run::ViewSource::kMeasured : run::ViewSource::kMap,
      command.threads, [&](const PinholeCamera& camera, const run::KeyframeView& view) -> Status {
        fusion.add(camera, view.T_world_camera, view.depth, view.color);
        return {};
      }));
  mesh::TriangleMesh mesh = fusion.mesh();
  if (mesh.triangles.empty()) {
    return fail(ErrorCode::kInvalidArgument, "no surface was seen from two keyframes",
                "a longer run, or --voxel with a larger value");
  }
  if (command.upright) {
    SGS_ASSIGN_OR_RETURN(const SE3 T_upright_world, run::load_run_upright(command.run));
    for (io::ColoredPoint& vertex : mesh.vertices) {
      vertex.position = (T_upright_world * vertex.position.cast<double>()).cast<float>();
    }
  }
  return io::save_mesh(command.output, mesh.vertices, mesh.triangles);
}

/// How far it is to the nearest surface, as OpenVDB.
Status make_distance_field(const MeshCommand& command) {
  run::OccupancyOptions options = command.occupancy;
  options.threads = command.threads;
  if (!command.up.empty())
    options.up = Eigen::Vector3d(command.up[0], command.up[1], command.up[2]);
  SGS_ASSIGN_OR_RETURN(const auto seen, run::occupancy_of(command.run, options));
  return mesh::save_distance_field(command.output, seen.volume, command.limit_m);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App options{"Makes what `sgs export RUN mesh` and `esdf` write"};
  MeshCommand command;
  options.add_option("RUN", command.run)->required();
  options.add_option("OUT", command.output)->required();
  options.add_option("--voxel", command.voxel_m);
  options.add_option("--threads", command.threads);
  options.add_flag("--measured-depth", command.measured);
  options.add_flag("--upright", command.upright);
  options.add_flag("--distance", command.distance);
  options.add_option("--resolution", command.occupancy.voxel_m);
  options.add_option("--range", command.occupancy.range_m);
  options.add_flag("--from-map", command.occupancy.from_map);
  options.add_option("--up", command.up)->delimiter(',')->expected(3);
  CLI11_PARSE(options, argc, argv);
  return app::end_helper(command.distance ? make_distance_field(command) : make_mesh(command));
} catch (...) {
  return app::end_helper(tl::unexpected(current_error()));
}
