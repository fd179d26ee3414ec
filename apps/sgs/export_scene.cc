// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "run_request.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/colmap.h"
#include "sgs/io/image_io.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::app {

namespace fs = std::filesystem;

std::vector<io::ColoredPoint> to_points(std::span<const map::Gaussian> gaussians) {
  std::vector<io::ColoredPoint> points;
  for (const map::Gaussian& g : gaussians) {
    if (g.opacity_logit < 0) continue;
    points.push_back({{g.mean[0], g.mean[1], g.mean[2]},
                      {to_byte(g.rgb[0]), to_byte(g.rgb[1]), to_byte(g.rgb[2])}});
  }
  return points;
}

Result<KeyframeViews> load_keyframe_views(const std::string& run) {
  std::error_code error;
  if (!fs::is_directory(run, error)) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}' is not a run folder", run),
                "this format needs the run's keyframes and input, not only its map");
  }
  KeyframeViews views;
  SGS_ASSIGN_OR_RETURN(const auto saved, load_saved_run(run));
  SGS_ASSIGN_OR_RETURN(views.input, open_input(saved.input, 1));
  views.camera = views.input.source->camera();
  SGS_ASSIGN_OR_RETURN(auto keyframes, io::load_trajectory(fs::path(run) / "keyframes.txt"));
  views.keyframes = std::move(keyframes.trajectory);
  if (views.keyframes.empty()) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{} holds no keyframes", run));
  }
  return views;
}

Status for_each_keyframe(KeyframeViews& views,
                         const std::function<Status(const RgbdFrame&, const SE3&)>& visit) {
  RgbdFrame frame;
  Error error;
  std::size_t found = 0;
  while (found < views.keyframes.size()) {
    const auto status = views.input.source->next(frame, error);
    if (status == dataset::FrameRead::kEnd) break;
    if (status == dataset::FrameRead::kBadFrame) continue;
    const auto pose = views.keyframes.at(frame.timestamp_s, 0.0);
    if (!pose) continue;
    ++found;
    SGS_RETURN_IF_ERROR(visit(frame, *pose));
  }
  if (found == 0) {
    return fail(ErrorCode::kNotFound, "no frame of the input has the time of a keyframe",
                "has the input changed since the run?");
  }
  return {};
}

Status export_colmap(const std::string& run, std::span<const map::Gaussian> gaussians,
                     const fs::path& folder) {
  SGS_ASSIGN_OR_RETURN(auto views, load_keyframe_views(run));
  std::vector<io::ColmapImage> images;
  SGS_RETURN_IF_ERROR(for_each_keyframe(views, [&](const RgbdFrame& frame, const SE3& pose) {
    images.push_back({fmt::format("frame_{:06}.png", frame.index), pose});
    return io::save_color(folder / "images" / images.back().name, frame.color);
  }));
  return io::save_colmap_model(folder / "sparse" / "0", views.camera, images, to_points(gaussians));
}

}  // namespace sgs::app
