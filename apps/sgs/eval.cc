// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "log_setup.h"
#include "run_request.h"
#include "score.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct EvalCommand {
  std::vector<std::string> runs;
  std::string association = "interpolate";
  ScoreOptions score;
  bool json = false;
};

Result<FinishedRun> load_finished_run(const std::string& folder, eval::Metrics& metrics) {
  SGS_ASSIGN_OR_RETURN(auto saved, load_saved_run(folder));
  FinishedRun run;
  run.input = saved.input;
  run.config = saved.config;
  const fs::path path = folder;
  SGS_ASSIGN_OR_RETURN(auto trajectory, io::load_trajectory(path / "trajectory.txt"));
  run.trajectory = std::move(trajectory.trajectory);
  SGS_ASSIGN_OR_RETURN(auto truth, io::load_trajectory(path / "groundtruth.txt"));
  run.truth = std::move(truth.trajectory);
  SGS_ASSIGN_OR_RETURN(run.gaussians, io::load_splats(path / "map.ply"));
  SGS_ASSIGN_OR_RETURN(run.frames_csv, io::read_file(path / "frames.csv"));
  SGS_ASSIGN_OR_RETURN(run.config_toml, io::read_file(path / "config.toml"));
  // What only the run itself could measure (speed, memory) is kept where it is known.
  if (std::error_code error; fs::exists(path / "metrics.json", error)) {
    SGS_ASSIGN_OR_RETURN(metrics, eval::load_metrics(path / "metrics.json"));
  }
  metrics.seed = static_cast<std::int64_t>(run.config.seed);
  metrics.preset = run.config.preset;
  metrics.tracker = run.config.tracker.type;
  run.name = fs::path(run.input.input).filename().string();
  run.frames = std::count(run.frames_csv.begin(), run.frames_csv.end(), '\n') - 1;
  run.frames = std::max(run.frames, metrics.frames.value_or(0));
  return run;
}

Result<eval::Metrics> evaluate_folder(const std::string& folder_name, const ScoreOptions& options) {
  eval::Metrics metrics;
  SGS_ASSIGN_OR_RETURN(const auto run, load_finished_run(folder_name, metrics));
  SGS_ASSIGN_OR_RETURN(auto folder, RunFolder::open(folder_name));
  SGS_ASSIGN_OR_RETURN(metrics, score_run(run, options, metrics, folder));
  if (!folder.failures().empty()) return tl::unexpected(folder.failures().front());
  return metrics;
}

int run_eval(EvalCommand& command) {
  const auto association = eval::parse_association(command.association);
  if (!association) return report(association.error());
  command.score.association = *association;
  setup_logging({}, command.score.quiet);
  std::vector<std::pair<std::string, eval::Metrics>> results;
  for (const std::string& folder : command.runs) {
    const auto metrics = evaluate_folder(folder, command.score);
    if (!metrics) return report(metrics.error());
    results.emplace_back(fs::path(folder).filename().string(), *metrics);
  }
  if (command.json) {
    std::string text;
    for (const auto& [name, metrics] : results) {
      text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ",\n", name, eval::to_json(metrics));
    }
    if (results.size() == 1) {
      fmt::print("{}\n", eval::to_json(results[0].second));
    } else {
      fmt::print("{{{}}}\n", text);
    }
  } else if (results.size() == 1) {
    fmt::print("{}", eval::metrics_table(results[0].second));
  } else {
    fmt::print("{}", eval::comparison_table(results));
  }
  return kExitDone;
}

}  // namespace

void add_eval(CLI::App& app, Action& action) {
  auto command = std::make_shared<EvalCommand>();
  auto* sub = app.add_subcommand("eval", "Compute the scores of finished runs again");
  sub->add_option("RUN", command->runs, "Run folders; several are compared")->required();
  sub->add_option("--association", command->association, "interpolate, nearest or nice-slam");
  sub->add_option("--lpips-weights", command->score.lpips_weights, "LPIPS-Alex v0.1 weights");
  sub->add_option("--lpips-stride", command->score.lpips_stride, "LPIPS on every n-th frame")
      ->check(CLI::PositiveNumber);
  sub->add_option("--threads", command->score.threads, "Threads")->check(CLI::Range(1, 256));
  sub->add_flag("--quiet", command->score.quiet, "No progress");
  sub->add_flag("--json", command->json, "Print the metrics as JSON");
  sub->callback([command, &action] { action = [command] { return run_eval(*command); }; });
}

}  // namespace sgs::app
