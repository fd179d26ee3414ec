// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "score.h"

#include <algorithm>
#include <cmath>

#include "frame_table.h"
#include "interrupt.h"
#include "progress.h"
#include "report_source.h"
#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/eval/run_evaluator.h"
#include "sgs/report/report.h"

namespace sgs::app {
namespace {

std::vector<double> finite(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  return values;
}

double count_if_text(const std::vector<std::string>& cells, std::string_view value) {
  return static_cast<double>(std::count(cells.begin(), cells.end(), value));
}

/// Estimates with the frame numbers and lost flags of frames.csv.
std::vector<eval::PoseEstimate> estimates_of(const FinishedRun& run, const FrameTable& table) {
  const auto times = table.numbers("timestamp_s"), indices = table.numbers("index");
  const auto status = table.texts("status");
  std::vector<eval::PoseEstimate> estimates;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto pose = run.trajectory.at(times[i], 0.0);
    if (!pose || status[i] == "bad") continue;
    estimates.push_back(
        {static_cast<std::int64_t>(indices[i]), times[i], *pose, status[i] == "lost"});
  }
  return estimates;
}

void set_frame_metrics(const FrameTable& table, std::int64_t frames, eval::Metrics& metrics) {
  const auto status = table.texts("status");
  const double ok = count_if_text(status, "ok"), degenerate = count_if_text(status, "degenerate");
  metrics.frames = frames;
  metrics.frames_tracked = static_cast<std::int64_t>(ok + degenerate);
  metrics.frames_lost = static_cast<std::int64_t>(count_if_text(status, "lost"));
  if (ok + degenerate > 0) {
    metrics.degenerate_percent = 100 * degenerate / (ok + degenerate);
    metrics.prior_percent =
        100 * count_if_text(table.texts("prior_active"), "1") / (ok + degenerate);
  }
  const auto track_ms = finite(table.numbers("track_ms"));
  if (!track_ms.empty()) {
    metrics.track_ms_p50 = quantile(track_ms, 0.5);
    metrics.track_ms_p95 = quantile(track_ms, 0.95);
  }
}

eval::TrajectoryMetrics score_trajectory(const FinishedRun& run, const FrameTable& table,
                                         eval::Association association) {
  eval::TrajectoryOptions options;
  options.association = association;
  options.frames_total = run.frames;
  return eval::evaluate_trajectory(estimates_of(run, table), run.truth, options);
}

Result<eval::RunEvaluation> score_rendering(const FinishedRun& run, const ScoreOptions& options) {
  SGS_ASSIGN_OR_RETURN(auto input, open_input(run.input, options.threads));
  std::optional<eval::Lpips> lpips;
  if (!options.lpips_weights.empty()) {
    SGS_ASSIGN_OR_RETURN(lpips, eval::Lpips::load(options.lpips_weights));
  }
  ThreadPool pool(options.threads);
  const auto rasterizer = render::make_cpu_rasterizer(&pool);
  eval::RunEvaluatorConfig config;
  config.lpips_stride = options.lpips_stride;
  config.heldout_interval = run.config.heldout_interval;

  Progress progress("frames scored", run.frames, options.quiet);
  std::int64_t shown = 0;
  eval::RunInput evaluation;
  evaluation.next_frame = [&](RgbdFrame& frame) {
    Error error;
    while (true) {
      const auto status = input.source->next(frame, error);
      if (status == dataset::FrameRead::kOk) return true;
      if (status == dataset::FrameRead::kEnd) return false;
    }
  };
  evaluation.pose_of = [&](const RgbdFrame& frame) {
    return run.trajectory.at(frame.timestamp_s, 0.0);
  };
  evaluation.frames_expected = run.frames;
  evaluation.gaussians = run.gaussians;
  evaluation.rasterizer = rasterizer.get();
  evaluation.lpips = lpips ? &*lpips : nullptr;
  evaluation.pool = &pool;
  evaluation.cancelled = [] { return interrupted(); };
  evaluation.progress = [&](std::int64_t seen) {
    for (; shown < seen; ++shown) progress.step("");
  };
  auto result = eval::evaluate_run(evaluation, config);
  progress.finish();
  return result;
}

}  // namespace

Result<eval::Metrics> score_run(const FinishedRun& run, const ScoreOptions& options,
                                eval::Metrics metrics, RunFolder& folder) {
  SGS_ASSIGN_OR_RETURN(const auto table, FrameTable::parse(run.frames_csv, "frames.csv"));
  set_frame_metrics(table, run.frames, metrics);
  const auto scores = score_trajectory(run, table, options.association);
  metrics.set(scores);

  std::optional<eval::RunEvaluation> rendering;
  if (options.rendering && !run.gaussians.empty()) {
    SGS_ASSIGN_OR_RETURN(rendering, score_rendering(run, options));
    metrics.set(*rendering);
  }
  auto report = make_report(run, table, scores, metrics);
  if (rendering) {
    report.pictures = rendering->pictures;
    report.notes.push_back(rendering->protocol);
    save_pictures(rendering->pictures, folder);
  }
  if (const auto note = degeneracy_note(metrics); !note.empty()) log().warn("{}", note);
  folder.save("metrics.json",
              [&](const std::filesystem::path& path) { return eval::save_metrics(path, metrics); });
  folder.save("report.html",
              [&](const std::filesystem::path& path) { return report::save_report(path, report); });
  return metrics;
}

Result<report::ReportData> saved_report(const std::string& folder, eval::Association association) {
  SGS_ASSIGN_OR_RETURN(auto loaded, load_finished_run(folder));
  SGS_ASSIGN_OR_RETURN(const auto table, FrameTable::parse(loaded.run.frames_csv, "frames.csv"));
  set_frame_metrics(table, loaded.run.frames, loaded.metrics);
  const auto scores = score_trajectory(loaded.run, table, association);
  loaded.metrics.set(scores);
  auto report = make_report(loaded.run, table, scores, loaded.metrics);
  report.pictures = load_pictures(folder);
  return report;
}

}  // namespace sgs::app
