// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/map.h"

#include <filesystem>

#include "sgs/api/internal/access.h"
#include "sgs/api/internal/convert.h"
#include "sgs/api/internal/guard.h"
#include "sgs/export/turned_map.h"
#include "sgs/io/glb.h"
#include "sgs/io/ply.h"
#include "sgs/io/splat_file.h"
#include "sgs/io/spz.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/rendered_images.h"
#include "sgs/render/view_color.h"
#include "sgs/runfolder/run.h"

namespace sgs::api {
namespace {

template <std::size_t N>
ArrayView view_of(const std::vector<map::Gaussian>& gaussians,
                  const float (map::Gaussian::*field)[N]) {
  const float* first = gaussians.empty() ? nullptr : gaussians.front().*field;
  return {first, gaussians.size(), N, sizeof(map::Gaussian)};
}

Rendering to_api_rendering(const render::Rendering& rendering) {
  constexpr float kSolid = 0.5f;
  const auto& color = rendering.color;
  const DepthImage depth = render::mean_depth(rendering, kSolid);
  Rendering out;
  out.width = color.width();
  out.height = color.height();
  out.color.reserve(3 * color.size());
  for (std::size_t i = 0; i < color.size(); ++i) {
    const render::Rgbf& pixel = color.data()[i];
    out.color.insert(out.color.end(), {pixel.r, pixel.g, pixel.b});
  }
  out.depth.assign(depth.data(), depth.data() + depth.size());
  out.alpha.assign(rendering.alpha.data(), rendering.alpha.data() + rendering.alpha.size());
  return out;
}

Status save_by_name(const std::filesystem::path& path, const map::Snapshot& map) {
  const std::string ending = path.extension().string();
  if (ending == ".spz") return io::save_spz(path, map.gaussians, map.harmonics);
  if (ending == ".splat") return io::save_splat_file(path, map.gaussians);
  if (ending != ".glb") return io::save_splats(path, map.gaussians, map.harmonics);
  map::SplatMap turned{map.gaussians, map.harmonics};
  run::move_into({io::gltf_from_camera_axes(), Eigen::Vector3d::Zero()}, turned);
  return io::save_glb(path, turned.gaussians, turned.harmonics);
}

}  // namespace

struct Map::Impl {
  map::SnapshotPtr snapshot;
};

Map::Map(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Map::Map(const Map&) = default;
Map& Map::operator=(const Map&) = default;
Map::~Map() = default;

Map Map::load(const std::string& path) {
  return internal::guarded([&] {
    std::error_code unreadable;
    const bool folder = std::filesystem::is_directory(path, unreadable);
    return internal::MapAccess::make(run::as_snapshot(
        internal::value_or_raise(folder ? run::load_run_map(path) : io::load_splats(path))));
  });
}

std::size_t Map::size() const { return impl_->snapshot->gaussians.size(); }
ArrayView Map::positions() const {
  return view_of(impl_->snapshot->gaussians, &map::Gaussian::mean);
}
ArrayView Map::log_scales() const {
  return view_of(impl_->snapshot->gaussians, &map::Gaussian::log_scale);
}
ArrayView Map::rotations() const {
  return view_of(impl_->snapshot->gaussians, &map::Gaussian::rotation);
}
ArrayView Map::opacity_logits() const {
  const auto& gaussians = impl_->snapshot->gaussians;
  const float* first = gaussians.empty() ? nullptr : &gaussians.front().opacity_logit;
  return {first, gaussians.size(), 1, sizeof(map::Gaussian)};
}
ArrayView Map::colors() const { return view_of(impl_->snapshot->gaussians, &map::Gaussian::rgb); }

std::vector<Pose> Map::keyframe_poses() const {
  std::vector<Pose> poses;
  for (const SE3& T : impl_->snapshot->T_world_keyframe) poses.push_back(internal::to_api(T));
  return poses;
}
std::vector<std::int64_t> Map::keyframe_frames() const { return impl_->snapshot->keyframe_frames; }

Rendering Map::render(const Camera& camera, const Pose& T_world_camera, int threads) const {
  return internal::guarded([&] {
    const LensCamera lens = internal::value_or_raise(internal::from_api(camera));
    const SE3 T = internal::value_or_raise(internal::from_api(T_world_camera));
    internal::check_threads(threads);
    ThreadPool pool(threads);
    render::Rendering rendering;
    render::ViewColors colors(&pool);
    const map::Snapshot& map = *impl_->snapshot;
    render::make_cpu_rasterizer(&pool)->render(colors.seen(map.gaussians, map.harmonics, T.t),
                                               lens.camera, T, rendering);
    return to_api_rendering(rendering);
  });
}

void Map::save(const std::string& path) const {
  internal::guarded([&] { internal::check_or_raise(save_by_name(path, *impl_->snapshot)); });
}

namespace internal {

Map MapAccess::make(map::SnapshotPtr snapshot) {
  return Map(std::make_shared<const Map::Impl>(Map::Impl{std::move(snapshot)}));
}

}  // namespace internal
}  // namespace sgs::api
