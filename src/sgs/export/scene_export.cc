// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/export/scene_export.h"

#include <fmt/format.h>

#include <algorithm>

#include "sgs/camera/movers.h"
#include "sgs/core/log.h"
#include "sgs/io/colmap.h"
#include "sgs/io/image_io.h"
#include "sgs/render/rendered_images.h"
#include "sgs/render/view_color.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

using Visit = std::function<Status(const PinholeCamera&, const KeyframeView&)>;

/// Camera and refined keyframes of a run folder; there is at least one keyframe.
Result<Run> load_keyframes(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("'{}' is not a run folder", folder.string()),
                "this format needs the run's keyframes, not only its map");
  }
  const unsigned movers = fs::exists(folder / files::kMovers, error) ? kFrames : kNoParts;
  SGS_ASSIGN_OR_RETURN(auto run, load_run(folder, kCamera | kKeyframes | movers));
  if (run.keyframes.empty()) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} holds no keyframes", folder.string()));
  }
  return run;
}

/// Takes out of a frame what moved in it, where the run has found that out.
void leave_out_movers_of(const Run& run, RgbdFrame& frame) {
  const auto record = std::lower_bound(
      run.frames.begin(), run.frames.end(), frame.index,
      [](const slam::FrameRecord& r, std::int64_t index) { return r.index < index; });
  if (record == run.frames.end() || record->index != frame.index) return;
  leave_out_movers(frame,
                   still_from_blocks(record->movers, frame.depth.width(), frame.depth.height()));
}

/// The keyframes' frames, read from the recording.
Status visit_recorded(const Run& run, dataset::FrameSource& source, const Visit& visit) {
  RgbdFrame frame;
  Error error;
  std::size_t found = 0;
  while (found < run.keyframes.size()) {
    const auto status = source.next(frame, error);
    if (status == dataset::FrameRead::kEnd) break;
    if (status != dataset::FrameRead::kOk) continue;
    const auto pose = run.keyframes.at(frame.timestamp_s, 0.0);
    if (!pose) continue;
    ++found;
    leave_out_movers_of(run, frame);
    KeyframeView view{frame.index, *pose, std::move(frame.color), std::move(frame.depth)};
    SGS_RETURN_IF_ERROR(visit(frame.camera, view));
  }
  if (found == 0) {
    return fail(ErrorCode::kNotFound, "no frame of the input has the time of a keyframe",
                "has the input changed since the run?");
  }
  return {};
}

}  // namespace

std::vector<io::ColoredPoint> to_points(std::span<const map::Gaussian> gaussians) {
  std::vector<io::ColoredPoint> points;
  for (const map::Gaussian& g : gaussians) {
    if (g.opacity_logit < 0) continue;
    points.push_back({{g.mean[0], g.mean[1], g.mean[2]},
                      {to_byte(g.rgb[0]), to_byte(g.rgb[1]), to_byte(g.rgb[2])}});
  }
  return points;
}

Status for_each_keyframe(const fs::path& folder, const map::SplatMap& map, ViewSource source,
                         int threads, const Visit& visit) {
  constexpr float kSolid = 0.7f;
  SGS_ASSIGN_OR_RETURN(const auto run, load_keyframes(folder));
  auto input = reopen_input(run.input, 1, run.calibration);
  if (source == ViewSource::kMeasured) {
    if (!input) return tl::unexpected(input.error());
    return visit_recorded(run, *input->source, visit);
  }
  ThreadPool pool(threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  render::ViewColors colors(&pool);
  render::Rendering rendering;
  const auto render = [&](const PinholeCamera& camera, const SE3& T) {
    rasterizer->render(colors.seen(map.gaussians, map.harmonics, T.t), camera, T, rendering);
  };
  if (input) {
    return visit_recorded(run, *input->source,
                          [&](const PinholeCamera& camera, const KeyframeView& seen) {
                            render(camera, seen.T_world_camera);
                            KeyframeView view = seen;
                            view.depth = render::mean_depth(rendering, kSolid);
                            return visit(camera, view);
                          });
  }
  log().warn("the recording is gone ({}): pictures are rendered from the map",
             input.error().message);
  std::int64_t index = 0;
  for (const StampedPose& pose : run.keyframes.poses()) {
    render(run.camera, pose.T_world_camera);
    SGS_RETURN_IF_ERROR(
        visit(run.camera, {index++, pose.T_world_camera, render::to_color_image(rendering.color),
                           render::mean_depth(rendering, kSolid)}));
  }
  return {};
}

Status export_colmap(const fs::path& run_folder, const map::SplatMap& map, const SE3& T_out_world,
                     const fs::path& folder) {
  std::vector<io::ColmapImage> images;
  PinholeCamera camera;
  SGS_RETURN_IF_ERROR(
      for_each_keyframe(run_folder, map, ViewSource::kMap, 1,
                        [&](const PinholeCamera& view_camera, const KeyframeView& view) {
                          camera = view_camera;
                          images.push_back({fmt::format("frame_{:06}.png", view.index),
                                            T_out_world * view.T_world_camera});
                          return io::save_color(folder / "images" / images.back().name, view.color);
                        }));
  auto points = to_points(map.gaussians);
  for (io::ColoredPoint& point : points) {
    point.position = (T_out_world * point.position.cast<double>()).cast<float>();
  }
  return io::save_colmap_model(folder / "sparse" / "0", camera, images, points);
}

}  // namespace sgs::run
