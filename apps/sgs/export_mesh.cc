// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_scene.h"
#include "sgs/mesh/depth_fusion.h"
#include "sgs/render/rasterizer.h"

namespace sgs::app {
namespace {

/// Mean depth where the map is mostly opaque.
DepthImage rendered_depth(const render::Rendering& rendering) {
  constexpr float kSolid = 0.7f;
  DepthImage depth(rendering.alpha.width(), rendering.alpha.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float alpha = rendering.alpha.data()[i];
    if (alpha > kSolid) depth.data()[i] = rendering.depth_sum.data()[i] / alpha;
  }
  return depth;
}

}  // namespace

Status export_mesh(const std::string& run, std::span<const map::Gaussian> gaussians,
                   const MeshOptions& options, const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(auto views, load_keyframe_views(run));
  ThreadPool pool(options.threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  mesh::DepthFusionConfig config;
  config.voxel_m = options.voxel_m;
  mesh::DepthFusion fusion(config);
  render::Rendering rendering;
  SGS_RETURN_IF_ERROR(
      for_each_keyframe(views, [&](const RgbdFrame& frame, const SE3& pose) -> Status {
        if (options.measured) {
          fusion.add(frame.camera, pose, frame.depth, frame.color);
        } else {
          rasterizer->render(gaussians, frame.camera, pose, rendering);
          fusion.add(frame.camera, pose, rendered_depth(rendering), frame.color);
        }
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
