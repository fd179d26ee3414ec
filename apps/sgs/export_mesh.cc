// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_mesh.h"

#include "sgs/io/ply.h"
#include "sgs/mesh/depth_fusion.h"
#include "sgs/run/scene_export.h"

namespace sgs::app {

Status export_mesh(const std::string& run, std::span<const map::Gaussian> gaussians,
                   const MeshOptions& options, const std::filesystem::path& path) {
  mesh::DepthFusionConfig config;
  config.voxel_m = options.voxel_m;
  mesh::DepthFusion fusion(config);
  SGS_RETURN_IF_ERROR(run::for_each_keyframe(
      run, gaussians, options.measured ? run::ViewSource::kMeasured : run::ViewSource::kMap,
      options.threads, [&](const PinholeCamera& camera, const run::KeyframeView& view) -> Status {
        fusion.add(camera, view.T_world_camera, view.depth, view.color);
        return {};
      }));
  const mesh::TriangleMesh mesh = fusion.mesh();
  if (mesh.triangles.empty()) {
    return fail(ErrorCode::kInvalidArgument, "no surface was seen from two keyframes",
                "a longer run, or --voxel with a larger value");
  }
  return io::save_mesh(path, mesh.vertices, mesh.triangles);
}

}  // namespace sgs::app
