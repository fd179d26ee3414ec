// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/make_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "sgs/tracker/tracker_kind.h"

namespace sgs::report {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Positions, aligned to the truth where that is possible, with their errors.
void set_paths(const run::Run& run, const eval::TrajectoryMetrics& scores, double start_s,
               ReportData& report) {
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
  // How a camera was held is a guess that likely_up() makes for a world of the truth's, too.
  const bool known = run.upright && run.upright->by != run::UprightBy::kCamera;
  report.up = known ? Eigen::Vector3d(T_truth_world.R * run.upright->up)
                    : likely_up(run.truth.empty() ? run.trajectory : run.truth);
}

/// The aligned error of each frame, where there is one.
Column error_column(const ReportData& report, const eval::TrajectoryMetrics& scores) {
  Column errors(report.frames.size(), kNone);
  for (const eval::FrameError& error : scores.errors) {
    const auto frame = std::lower_bound(
        report.frames.begin(), report.frames.end(), error.index,
        [](const slam::FrameRecord& r, std::int64_t index) { return r.index < index; });
    if (frame != report.frames.end()) {
      errors[static_cast<std::size_t>(frame - report.frames.begin())] = error.error_m;
    }
  }
  return errors;
}

void add_stages(const nlohmann::json& tree, const std::string& prefix,
                std::vector<StageSummary>& stages) {
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
std::vector<StageSummary> stages_of(const std::string& timings_json) {
  std::vector<StageSummary> stages;
  add_stages(nlohmann::json::parse(timings_json, nullptr, false), "", stages);
  return stages;
}

/// Says that the page shows a part of a run.
std::string part_note(const run::RunState& state) {
  if (state.stage == run::Stage::kFinished) return "";
  if (state.stage == run::Stage::kInterrupted) {
    return fmt::format("The run was interrupted ({}): everything here is about its first part.",
                       state.reason);
  }
  return "The run was not finished when this page was made: poses come from its journal and the "
         "map from its last checkpoint.";
}

}  // namespace

ReportData make_report(const run::Run& run, const run::Scores& scores) {
  const eval::Metrics& metrics = scores.metrics;
  ReportData report;
  report.title = run.name;
  report.subtitle = fmt::format("tracker {}, preset {}", metrics.tracker.value_or("?"),
                                metrics.preset.value_or("?"));
  report.facts = {{"frames", fmt::format("{}", run.frames.size())},
                  {"seed", fmt::format("{}", run.config.seed)},
                  {"threads", fmt::format("{}", metrics.threads.value_or(0))},
                  {"version", metrics.version.value_or("?")}};
  if (!run.input.frames.empty()) report.facts[0].second += " (" + run.input.frames + ")";
  report.metrics = metrics;
  for (const std::string& note :
       {run::degeneracy_note(metrics), scores.trajectory.protocol, scores.trajectory.note,
        run.upright ? "The world is " + run.upright->sentence() + "." : std::string(),
        part_note(run.state), scores.rendering ? scores.rendering->protocol : std::string(),
        scores.no_recording.empty() ? std::string() : "Scored anew, but " + scores.no_recording}) {
    if (!note.empty()) report.notes.push_back(note);
  }

  report.frames = run.frames;
  const double start_s = run.frames.empty() ? 0 : run.frames.front().timestamp_s;
  set_paths(run, scores.trajectory, start_s, report);
  report.error_m = error_column(report, scores.trajectory);
  const auto& tracker = run.config.tracker;
  report.condition_threshold = tracker.degeneracy.condition_threshold;
  report.snr_threshold = tracker.degeneracy.snr_threshold;
  report.decides_by_snr = tracker::decides_by_snr(tracker);
  if (tracker::weighs_planarity(tracker)) {
    report.planarity_threshold = tracker.degeneracy.planarity_full_prior;
  }
  report.stages = stages_of(run.timings_json);
  report.map = eval::map_statistics(run.gaussians);
  if (scores.rendering) report.pictures = scores.rendering->pictures;
  report.calibration = run.calibration;
  report.config_toml = run.config_toml;
  return report;
}

Result<ReportData> load_report(const std::filesystem::path& folder, eval::Association association) {
  SGS_ASSIGN_OR_RETURN(const auto run,
                       run::load_run(folder, run::kTrajectory | run::kTruth | run::kKeyframes |
                                                 run::kFrames | run::kMap));
  auto report = make_report(run, run::score_trajectory(run, association));
  report.pictures = run::load_pictures(folder);
  return report;
}

}  // namespace sgs::report
