// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "log_setup.h"
#include "run_request.h"
#include "score.h"
#include "sgs/report/comparison.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct EvalCommand {
  std::vector<std::string> runs;
  std::string association = "interpolate", output, plots;
  ScoreOptions score;
  bool json = false, compare = false;
};

Result<eval::Metrics> evaluate_folder(const std::string& folder_name, const ScoreOptions& options) {
  SGS_ASSIGN_OR_RETURN(const auto loaded, load_finished_run(folder_name));
  SGS_ASSIGN_OR_RETURN(auto folder, RunFolder::open(folder_name));
  SGS_ASSIGN_OR_RETURN(const auto metrics, score_run(loaded.run, options, loaded.metrics, folder));
  if (!folder.failures().empty()) return tl::unexpected(folder.failures().front());
  return metrics;
}

/// Name of a run folder, also of "." and "runs/latest/".
std::string folder_name(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(folder, error);
  return error || path.filename().empty() ? folder : path.filename().string();
}

/// --compare and --plots: nothing is rendered, nothing in the run folders changes.
Status draw_runs(const EvalCommand& command, eval::Association association) {
  std::vector<report::ReportData> runs;
  for (const std::string& folder : command.runs) {
    SGS_ASSIGN_OR_RETURN(auto report, saved_report(folder, association));
    report.label = folder_name(folder);
    runs.push_back(std::move(report));
  }
  if (!command.plots.empty()) {
    SGS_ASSIGN_OR_RETURN(const auto files,
                         report::save_drawings(command.plots, report::all_drawings(runs)));
    for (const fs::path& file : files) fmt::print("{}\n", file.string());
  }
  if (command.compare) {
    const fs::path output = command.output.empty() ? "report.html" : command.output;
    SGS_RETURN_IF_ERROR(report::save_comparison(output, runs));
    fmt::print("{}\n", output.string());
  }
  return {};
}

int run_eval(EvalCommand& command) {
  const auto association = eval::parse_association(command.association);
  if (!association) return report(association.error());
  command.score.association = *association;
  setup_logging({}, command.score.quiet);
  if (command.compare || !command.plots.empty()) {
    const Status drawn = draw_runs(command, *association);
    return drawn ? kExitDone : report(drawn.error());
  }
  std::vector<std::pair<std::string, eval::Metrics>> results;
  for (const std::string& folder : command.runs) {
    const auto metrics = evaluate_folder(folder, command.score);
    if (!metrics) return report(metrics.error());
    results.emplace_back(folder_name(folder), *metrics);
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
  auto* compare = sub->add_flag("--compare", command->compare,
                                "Write one page that compares the runs, from the scores they hold");
  sub->add_option("-o,--output", command->output, "With --compare: the page (default report.html)")
      ->needs(compare);
  sub->add_option("--plots", command->plots,
                  "Write the report's plots as .svg files into this folder; several runs: the "
                  "plots that compare them");
  sub->add_flag("--quiet", command->score.quiet, "No progress");
  sub->add_flag("--json", command->json, "Print the metrics as JSON");
  sub->callback([command, &action] { action = [command] { return run_eval(*command); }; });
}

}  // namespace sgs::app
