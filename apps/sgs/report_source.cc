// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "report_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace sgs::app {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

report::Column status_column(const std::vector<std::string>& status) {
  report::Column column;
  for (const std::string& s : status) {
    column.push_back(s == "ok" ? 0 : s == "degenerate" ? 1 : s == "lost" ? 2 : 3);
  }
  return column;
}

/// Positions, aligned to the truth where that is possible, with their errors.
void set_paths(const FinishedRun& run, const eval::TrajectoryMetrics& scores, double start_s,
               report::ReportData& report) {
  constexpr std::size_t kMapPoints = 30000;
  constexpr double kSameTime_s = 1e-6, kTruthMargin_s = 0.1;
  const SE3 T_truth_world = scores.T_truth_world.value_or(SE3{});
  auto error = scores.errors.begin();
  for (const StampedPose& pose : run.trajectory.poses()) {
    while (error != scores.errors.end() && error->timestamp_s < pose.timestamp_s - kSameTime_s) {
      ++error;
    }
    const bool same =
        error != scores.errors.end() && error->timestamp_s < pose.timestamp_s + kSameTime_s;
    report.estimate_m.push_back(T_truth_world * pose.T_world_camera.t);
    report.estimate_time_s.push_back(pose.timestamp_s - start_s);
    report.estimate_error_m.push_back(same ? error->error_m : kNone);
  }
  if (scores.errors.empty()) report.estimate_error_m.clear();
  for (const StampedPose& pose : run.truth.poses()) {
    if (!run.trajectory.empty() &&
        pose.timestamp_s >= run.trajectory.poses().front().timestamp_s - kTruthMargin_s &&
        pose.timestamp_s <= run.trajectory.poses().back().timestamp_s + kTruthMargin_s) {
      report.truth_m.push_back(pose.T_world_camera.t);
    }
  }
  for (const StampedPose& pose : run.keyframes.poses()) {
    report.keyframes.push_back(T_truth_world * pose.T_world_camera);
  }
  report.map_points = eval::sample_points(run.gaussians, kMapPoints, T_truth_world);
  report.up = report::likely_up(run.truth.empty() ? run.trajectory : run.truth);
}

void set_error_column(const FrameTable& table, const eval::TrajectoryMetrics& scores,
                      report::ReportData& report) {
  report.error_m.assign(table.rows(), kNone);
  const auto indices = table.numbers("index");
  for (const eval::FrameError& error : scores.errors) {
    const auto row =
        std::lower_bound(indices.begin(), indices.end(), static_cast<double>(error.index));
    if (row != indices.end()) {
      report.error_m[static_cast<std::size_t>(row - indices.begin())] = error.error_m;
    }
  }
}

void set_columns(const FrameTable& table, report::ReportData& report) {
  report.status = status_column(table.texts("status"));
  report.mapping_keyframe = table.numbers("mapping_keyframe");
  report.track_ms = table.numbers("track_ms");
  report.iterations = table.numbers("mapping_iterations");
  report.gaussians = table.numbers("gaussians");
  report.prior_active = table.numbers("prior_active");
  report.condition_number = table.numbers("condition_number");
  report.planarity = table.numbers("planarity");
  for (std::size_t k = 0; k < 6; ++k) {
    report.weights[k] = table.numbers(fmt::format("weight_{}", k));
    report.snr[k] = table.numbers(fmt::format("snr_{}", k));
  }
  for (const char* part : {"points", "index", "geometry", "visual", "update"}) {
    report.stage_ms.emplace_back(part, table.numbers(fmt::format("ms_{}", part)));
  }
}

void add_stages(const nlohmann::json& tree, const std::string& prefix,
                std::vector<report::StageSummary>& stages) {
  if (!tree.is_object()) return;
  for (const auto& [name, stage] : tree.items()) {
    if (!stage.is_object()) continue;
    const auto number = [&stage = stage](const char* key) {
      const auto found = stage.find(key);
      return found != stage.end() && found->is_number() ? found->template get<double>() : 0.0;
    };
    if (stage.contains("calls")) {
      stages.push_back({prefix + name, static_cast<std::int64_t>(number("calls")),
                        number("total_ms"), number("p50_ms"), number("p95_ms")});
    }
    if (const auto children = stage.find("children"); children != stage.end()) {
      add_stages(*children, prefix + name + "/", stages);
    }
  }
}

/// Stages of timings.json; what is not as expected there is left out.
std::vector<report::StageSummary> stages_of(const std::string& timings_json) {
  std::vector<report::StageSummary> stages;
  add_stages(nlohmann::json::parse(timings_json, nullptr, false), "", stages);
  return stages;
}

}  // namespace

report::ReportData make_report(const FinishedRun& run, const FrameTable& table,
                               const eval::TrajectoryMetrics& scores,
                               const eval::Metrics& metrics) {
  report::ReportData report;
  report.title = run.name;
  report.subtitle = fmt::format("tracker {}, preset {}", metrics.tracker.value_or("?"),
                                metrics.preset.value_or("?"));
  report.facts = {{"frames", fmt::format("{}", table.rows())},
                  {"seed", fmt::format("{}", run.config.seed)},
                  {"threads", fmt::format("{}", metrics.threads.value_or(0))},
                  {"version", metrics.version.value_or("?")}};
  if (!run.input.frames.empty()) report.facts[0].second += " (" + run.input.frames + ")";
  report.metrics = metrics;
  if (auto note = degeneracy_note(metrics); !note.empty()) report.notes.push_back(std::move(note));
  report.notes.push_back(scores.protocol);
  if (!scores.note.empty()) report.notes.push_back(scores.note);

  report.time_s = table.numbers("timestamp_s");
  const double start_s = report.time_s.empty() ? 0 : report.time_s.front();
  for (double& time : report.time_s) time -= start_s;
  set_paths(run, scores, start_s, report);
  set_error_column(table, scores, report);
  set_columns(table, report);
  const tracker::TrackerConfig& config = run.config.tracker;
  report.condition_threshold = config.degeneracy.condition_threshold;
  report.snr_threshold = config.degeneracy.snr_threshold;
  report.decides_by_snr = config.type == tracker::TrackerType::kSpectral;
  if (config.type == tracker::TrackerType::kPaper) {
    report.planarity_threshold = config.degeneracy.planarity_full_prior;
  }
  report.stages = stages_of(run.timings_json);
  report.map = eval::map_statistics(run.gaussians);
  report.config_toml = run.config_toml;
  return report;
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

}  // namespace sgs::app
