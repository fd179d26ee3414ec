// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "score.h"

#include <algorithm>
#include <cmath>

#include "frame_table.h"
#include "interrupt.h"
#include "progress.h"
#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/eval/run_evaluator.h"
#include "sgs/io/image_io.h"

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

eval::Column status_column(const std::vector<std::string>& status) {
  eval::Column column;
  for (const std::string& s : status) {
    column.push_back(s == "ok" ? 0 : s == "degenerate" ? 1 : s == "lost" ? 2 : 3);
  }
  return column;
}

/// Positions, aligned to the truth where that is possible.
void set_paths(const FinishedRun& run, const eval::TrajectoryMetrics& scores,
               eval::ReportData& report) {
  const SE3 T_truth_world = scores.T_truth_world.value_or(SE3{});
  for (const StampedPose& pose : run.trajectory.poses()) {
    report.estimate_m.push_back(T_truth_world * pose.T_world_camera.t);
  }
  for (const StampedPose& pose : run.truth.poses()) {
    if (!run.trajectory.empty() &&
        pose.timestamp_s >= run.trajectory.poses().front().timestamp_s - 0.1 &&
        pose.timestamp_s <= run.trajectory.poses().back().timestamp_s + 0.1) {
      report.truth_m.push_back(pose.T_world_camera.t);
    }
  }
}

eval::ReportData make_report(const FinishedRun& run, const FrameTable& table,
                             const eval::TrajectoryMetrics& scores, const eval::Metrics& metrics) {
  eval::ReportData report;
  report.title = run.name;
  report.subtitle = fmt::format("tracker {}, preset {}", metrics.tracker.value_or("?"),
                                metrics.preset.value_or("?"));
  report.facts = {{"seed", fmt::format("{}", run.config.seed)},
                  {"threads", fmt::format("{}", metrics.threads.value_or(0))},
                  {"version", metrics.version.value_or("?")}};
  report.metrics = metrics;
  report.notes.push_back(scores.protocol);
  if (!scores.note.empty()) report.notes.push_back(scores.note);
  set_paths(run, scores, report);

  report.time_s = table.numbers("timestamp_s");
  const double start_s = report.time_s.empty() ? 0 : report.time_s.front();
  for (double& time : report.time_s) time -= start_s;
  report.error_m.assign(table.rows(), std::numeric_limits<double>::quiet_NaN());
  const auto indices = table.numbers("index");
  for (const eval::FrameError& error : scores.errors) {
    const auto row =
        std::lower_bound(indices.begin(), indices.end(), static_cast<double>(error.index));
    if (row != indices.end()) {
      report.error_m[static_cast<std::size_t>(row - indices.begin())] = error.error_m;
    }
  }
  report.status = status_column(table.texts("status"));
  report.track_ms = table.numbers("track_ms");
  report.iterations = table.numbers("mapping_iterations");
  report.gaussians = table.numbers("gaussians");
  report.prior_active = table.numbers("prior_active");
  report.condition_number = table.numbers("condition_number");
  report.planarity = table.numbers("planarity");
  for (std::size_t k = 0; k < 6; ++k) {
    report.weights[k] = table.numbers(fmt::format("weight_{}", k));
  }
  report.config_toml = run.config_toml;
  return report;
}

/// Says in words when directions were unobservable and nothing filled them.
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

void save_pictures(const std::vector<eval::FramePictures>& pictures, RunFolder& folder) {
  for (const eval::FramePictures& p : pictures) {
    const auto save = [&](const char* what, const ColorImage& image) {
      folder.save(fmt::format("renders/{:06}_{}.png", p.index, what),
                  [&](const std::filesystem::path& path) { return io::save_color(path, image); });
    };
    save("truth", p.truth);
    save("render", p.rendering);
    save("error", p.error);
  }
}

}  // namespace

Result<eval::Metrics> score_run(const FinishedRun& run, const ScoreOptions& options,
                                eval::Metrics metrics, RunFolder& folder) {
  SGS_ASSIGN_OR_RETURN(const auto table, FrameTable::parse(run.frames_csv, "frames.csv"));
  set_frame_metrics(table, run.frames, metrics);
  eval::TrajectoryOptions trajectory_options;
  trajectory_options.association = options.association;
  trajectory_options.frames_total = run.frames;
  const auto scores =
      eval::evaluate_trajectory(estimates_of(run, table), run.truth, trajectory_options);
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
  if (const auto note = degeneracy_note(metrics); !note.empty()) {
    report.notes.insert(report.notes.begin(), note);
    log().warn("{}", note);
  }
  folder.save("metrics.json",
              [&](const std::filesystem::path& path) { return eval::save_metrics(path, metrics); });
  folder.save("report.html",
              [&](const std::filesystem::path& path) { return eval::save_report(path, report); });
  return metrics;
}

}  // namespace sgs::app
