// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_lag.h"
#include "sgs/core/stopwatch.h"
#include "sgs/refine/shutter.h"
#include "sgs/run/novel_views.h"

namespace sgs::run {
namespace {

/// Estimates with the frame numbers and lost flags of the frames.
std::vector<eval::PoseEstimate> estimates_of(const Run& run) {
  std::vector<eval::PoseEstimate> estimates;
  for (const slam::FrameRecord& frame : run.frames) {
    const auto pose = run.trajectory.at(frame.timestamp_s, 0.0);
    if (!pose || frame.bad) continue;
    estimates.push_back(
        {frame.index, frame.timestamp_s, *pose, frame.status == tracker::TrackingStatus::kLost});
  }
  return estimates;
}

void add_frame_metrics(const std::vector<slam::FrameRecord>& frames, eval::Metrics& metrics) {
  using tracker::TrackingStatus;
  std::int64_t tracked = 0, degenerate = 0, lost = 0, prior = 0;
  std::vector<double> track_ms;
  for (const slam::FrameRecord& frame : frames) {
    if (frame.bad) continue;
    const bool is_lost = frame.status == TrackingStatus::kLost;
    lost += is_lost ? 1 : 0;
    tracked += is_lost ? 0 : 1;
    degenerate += frame.status == TrackingStatus::kDegenerate ? 1 : 0;
    prior += frame.diagnostics.prior_active ? 1 : 0;
    if (std::isfinite(frame.track_ms)) track_ms.push_back(frame.track_ms);
  }
  metrics.frames_tracked = tracked;
  metrics.frames_lost = lost;
  if (tracked > 0) {
    metrics.degenerate_percent =
        100.0 * static_cast<double>(degenerate) / static_cast<double>(tracked);
    metrics.prior_percent = 100.0 * static_cast<double>(prior) / static_cast<double>(tracked);
  }
  if (!track_ms.empty()) {
    metrics.track_ms_p50 = quantile(track_ms, 0.5);
    metrics.track_ms_p95 = quantile(track_ms, 0.95);
  }
}

/// What refinement has learned of the exposure of a frame.
std::optional<std::array<float, 3>> gain_of(const Run& run, std::int64_t index) {
  const auto record = std::lower_bound(
      run.frames.begin(), run.frames.end(), index,
      [](const slam::FrameRecord& r, std::int64_t wanted) { return r.index < wanted; });
  if (record == run.frames.end() || record->index != index) return std::nullopt;
  std::array<float, 3> gain;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!std::isfinite(record->gain[c])) return std::nullopt;
    gain[c] = static_cast<float>(record->gain[c]);
  }
  return gain;
}

Result<eval::RunEvaluation> score_rendering(const Run& run, Input& input,
                                            const ScoreOptions& options, RunObserver& observer,
                                            const std::stop_token& stop) {
  std::optional<eval::Lpips> lpips;
  if (!options.lpips_weights.empty()) {
    SGS_ASSIGN_OR_RETURN(lpips, eval::Lpips::load(options.lpips_weights));
  }
  ThreadPool pool(options.threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  eval::RunEvaluatorConfig config = options.rendering;
  config.heldout_interval = run.config.heldout_interval;

  const Trajectory views = view_poses(run);
  const double learned_delay = learned_depth_delay_s(run);
  eval::RunInput evaluation;
  // A run that was stopped needs no frame after its last one.
  const std::int64_t last = run.frames.empty() ? -1 : run.frames.back().index;
  std::int64_t read = -1;
  evaluation.next_frame = [&](RgbdFrame& frame) {
    Error error;
    while (read < last) {
      const auto status = input.source->next(frame, error);
      if (status == dataset::FrameRead::kEnd) return false;
      read = frame.index;
      if (status != dataset::FrameRead::kOk) continue;
      // The map shows surfaces as they were when their colour was seen.
      const Vector6d lag =
          refine::twist_at(views, frame.timestamp_s, frame.depth_delay_s + learned_delay);
      frame.depth = depth_with_colour(frame.depth, frame.camera, lag);
      return read <= last;
    }
    return false;
  };
  evaluation.pose_of = [&](const RgbdFrame& frame) { return views.at(frame.timestamp_s, 0.0); };
  evaluation.gain_of = [&](const RgbdFrame& frame) { return gain_of(run, frame.index); };
  evaluation.frames_expected = run.frames_total;
  evaluation.gaussians = run.gaussians;
  evaluation.harmonics = &run.harmonics;
  evaluation.rasterizer = rasterizer.get();
  evaluation.lpips = lpips ? &*lpips : nullptr;
  evaluation.pool = &pool;
  evaluation.cancelled = [&] { return stop.stop_requested(); };
  evaluation.progress = [&](std::int64_t frames) { observer.on_frames_scored(frames); };
  return eval::evaluate_run(evaluation, config);
}

/// Judges views off the path where the truth of any view is known.
Status add_novel_views(const Run& run, const ScoreOptions& options, eval::Metrics& scores) {
  if (options.novel_views <= 0 || !synthetic::is_synth_spec(run.input.input)) return {};
  std::optional<eval::Lpips> lpips;
  if (!options.lpips_weights.empty()) {
    SGS_ASSIGN_OR_RETURN(lpips, eval::Lpips::load(options.lpips_weights));
  }
  SGS_ASSIGN_OR_RETURN(
      const auto novel,
      score_novel_views(run, options.novel_views, lpips ? &*lpips : nullptr, options.threads));
  scores.psnr_db_novel = novel.psnr_db;
  scores.ssim_novel = novel.ssim;
  scores.lpips_novel = novel.lpips;
  scores.depth_l1_novel_m = novel.depth_l1_m;
  return {};
}

/// The recording cannot be opened: scores of pictures that are there stay and are marked.
void note_no_recording(const Error& why, Scores& scores) {
  const bool kept = scores.metrics.psnr_db.has_value();
  if (kept) scores.metrics.pictures = eval::kKeptPictures;
  scores.no_recording = fmt::format(
      "the recording cannot be opened ({}): no picture was compared with it; {}", why.message,
      kept ? "the scores of pictures are those of an earlier time" : "pictures have no scores");
}

}  // namespace

Scores score_trajectory(const Run& run, eval::Association association) {
  eval::TrajectoryOptions options;
  options.association = association;
  options.frames_total = run.frames_total;
  Scores scores;
  scores.trajectory = eval::evaluate_trajectory(estimates_of(run), run.truth, options);
  scores.metrics = run.metrics;
  eval::replace_group(scores.metrics, eval::kTrajectoryGroup, scores.trajectory.scores);
  if (!run.online.empty()) {
    const auto online =
        eval::evaluate_trajectory(eval::to_estimates(run.online), run.truth, options);
    scores.metrics.ate_online_rmse_m = online.scores.ate_rmse_m;
  }
  add_frame_metrics(run.frames, scores.metrics);
  return scores;
}

Result<Scores> score_run(const Run& run, const ScoreOptions& options, RunObserver& observer,
                         const std::stop_token& stop) {
  Scores scores = score_trajectory(run, options.association);
  if (run.gaussians.empty()) return scores;
  auto input = reopen_input(run.input, options.threads, run.calibration);
  if (!input) {
    note_no_recording(input.error(), scores);
    return scores;
  }
  SGS_ASSIGN_OR_RETURN(scores.rendering, score_rendering(run, *input, options, observer, stop));
  const bool whole = !scores.rendering->cancelled;
  if (whole) SGS_RETURN_IF_ERROR(add_novel_views(run, options, scores.rendering->scores));
  eval::replace_group(scores.metrics, eval::kRenderingGroup,
                      whole ? scores.rendering->scores : eval::Metrics{});
  return scores;
}

std::string degeneracy_note(const eval::Metrics& metrics) {
  const double degenerate = metrics.degenerate_percent.value_or(0);
  const double filled = metrics.prior_percent.value_or(0);
  if (degenerate < 1 || filled >= 0.5 * degenerate) return "";
  return fmt::format(
      "Geometry alone left at least one direction unobserved in {:.0f} % of the frames and nothing "
      "filled it in: the pose can slide along that direction. The tracker 'spectral' fills it from "
      "vision.",
      degenerate);
}

}  // namespace sgs::run
