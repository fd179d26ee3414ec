// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/novel_views.h"

#include <array>
#include <numbers>
#include <vector>

#include "sgs/eval/image_metrics.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/view_color.h"

namespace sgs::run {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Ways off the path, taken in turn: camera twists, rotation first.
const std::array<Vector6d, 6> kOffsets = [] {
  std::array<Vector6d, 6> offsets;
  offsets[0] << 0, 6 * kDegree, 0, 0.15, 0, 0;
  offsets[1] << 0, -6 * kDegree, 0, -0.15, 0, 0;
  offsets[2] << -5 * kDegree, 0, 0, 0, 0.12, 0;
  offsets[3] << 5 * kDegree, 0, 0, 0, -0.12, 0;
  offsets[4] << 0, 0, 8 * kDegree, 0, 0, 0.15;
  offsets[5] << 4 * kDegree, 4 * kDegree, 0, 0.08, -0.08, -0.1;
  return offsets;
}();

/// One view: the truth and the map's rendering.
struct View {
  eval::ColorFloatImage truth;
  DepthImage depth;
  render::Rendering rendering;
};

bool looks_into_a_wall(const DepthImage& depth) {
  constexpr float kNear_m = 0.3f;
  std::size_t near = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    near += depth.data()[i] > 0 && depth.data()[i] < kNear_m ? 1 : 0;
  }
  return near * 100 > depth.size();
}

/// Frames with an estimated and a true pose, a few spread evenly.
std::vector<MovedPose> chosen_poses(const Run& run, const Trajectory& truths, int count) {
  constexpr double kMaxGap_s = 0.1;
  const Trajectory views = view_poses(run);
  std::vector<MovedPose> all;
  for (const slam::FrameRecord& frame : run.frames) {
    if (frame.bad || frame.status == tracker::TrackingStatus::kLost) continue;
    const auto estimate = views.at(frame.timestamp_s, 0.0);
    const auto truth = truths.at(frame.timestamp_s, kMaxGap_s);
    if (estimate && truth) all.push_back({frame.timestamp_s, *estimate, *truth});
  }
  const auto wanted = std::min(all.size(), static_cast<std::size_t>(count));
  std::vector<MovedPose> chosen;
  for (std::size_t i = 0; i < wanted; ++i) {
    chosen.push_back(all[(2 * i + 1) * all.size() / (2 * wanted)]);
  }
  return chosen;
}

/// The gain per channel that brings the renderings nearest to the truth, where the map is solid.
std::array<float, 3> common_gain(const std::vector<View>& views) {
  constexpr float kSolid = 0.9f;
  std::array<double, 3> products{}, squares{};
  for (const View& view : views) {
    for (std::size_t i = 0; i < view.truth.size(); ++i) {
      if (view.rendering.alpha.data()[i] < kSolid) continue;
      const render::Rgbf &y = view.truth.data()[i], &r = view.rendering.color.data()[i];
      const std::array<double, 3> truth = {y.r, y.g, y.b}, drawn = {r.r, r.g, r.b};
      for (std::size_t c = 0; c < 3; ++c) {
        products[c] += truth[c] * drawn[c];
        squares[c] += drawn[c] * drawn[c];
      }
    }
  }
  std::array<float, 3> gain = {1, 1, 1};
  for (std::size_t c = 0; c < 3; ++c) {
    if (squares[c] > 0) gain[c] = static_cast<float>(products[c] / squares[c]);
  }
  return gain;
}

}  // namespace

Result<NovelScores> score_novel_views(const Run& run, int count, const eval::Lpips* lpips,
                                      int threads) {
  SGS_ASSIGN_OR_RETURN(const auto options, synth_options(run.input, threads));
  SGS_ASSIGN_OR_RETURN(const auto scene, synthetic::make_scene(options));
  // Camera and truth of the generator, to the last bit: a folder may lack them or have them
  // rounded.
  SGS_ASSIGN_OR_RETURN(const auto source, synthetic::make_synthetic_source(options));
  const PinholeCamera camera = source->camera();
  ThreadPool pool(threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  render::ViewColors colors(&pool);
  std::vector<View> views;
  std::size_t number = 0;
  for (const MovedPose& pose : chosen_poses(run, source->ground_truth(), count)) {
    const SE3 offset = SE3::exp(kOffsets[number++ % kOffsets.size()]);
    auto exact = synthetic::render_exact(*scene, camera, pose.after * offset, pool);
    if (looks_into_a_wall(exact.depth)) continue;
    View& view = views.emplace_back();
    view.truth = eval::to_float(exact.color);
    view.depth = std::move(exact.depth);
    const SE3 T = pose.before * offset;
    rasterizer->render(colors.seen(run.gaussians, run.harmonics, T.t), camera, T, view.rendering);
  }
  NovelScores scores;
  scores.views = static_cast<int>(views.size());
  if (views.empty()) return scores;
  const auto gain = common_gain(views);
  double psnr = 0, ssim = 0, distance = 0, depth = 0;
  int with_depth = 0;
  for (const View& view : views) {
    const auto image = eval::clamped(eval::brightened(view.rendering.color, gain));
    psnr += eval::psnr_db(view.truth, image);
    ssim += eval::ssim(view.truth, image).value_or(0);
    if (lpips != nullptr) distance += lpips->distance(view.truth, image).value_or(0);
    if (const auto error = eval::depth_error(view.depth, view.rendering)) {
      depth += error->l1_m;
      ++with_depth;
    }
  }
  const auto n = static_cast<double>(views.size());
  scores.psnr_db = psnr / n;
  scores.ssim = ssim / n;
  if (lpips != nullptr) scores.lpips = distance / n;
  if (with_depth > 0) scores.depth_l1_m = depth / with_depth;
  return scores;
}

}  // namespace sgs::run
