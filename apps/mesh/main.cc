// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// sgs-mesh: what `sgs export RUN mesh` starts. A program of its own, because OpenVDB is heavier
// than everything else together. What went wrong goes to standard output, message and remedy on a
// line each; `sgs` says it.
#include <CLI/CLI.hpp>
#include <csignal>
#include <string>

#include "helper_end.h"
#include "sgs/export/scene_export.h"
#include "sgs/io/ply.h"
#include "sgs/mesh/depth_fusion.h"
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

}  // namespace

int main(int argc, char** argv) try {
  CLI::App options{"Makes the mesh of `sgs export RUN mesh`"};
  MeshCommand command;
  options.add_option("RUN", command.run)->required();
  options.add_option("OUT", command.output)->required();
  options.add_option("--voxel", command.voxel_m);
  options.add_option("--threads", command.threads);
  options.add_flag("--measured-depth", command.measured);
  options.add_flag("--upright", command.upright);
  CLI11_PARSE(options, argc, argv);
  return app::end_helper(make_mesh(command));
} catch (...) {
  return app::end_helper(tl::unexpected(current_error()));
}
