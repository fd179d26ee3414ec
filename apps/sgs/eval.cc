// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "interrupt.h"
#include "log_setup.h"
#include "scoring.h"
#include "sgs/core/print.h"
#include "sgs/report/comparison.h"
#include "sgs/report/make_report.h"
#include "sgs/report/report.h"
#include "sgs/report/save_scores.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct EvalCommand {
  std::vector<std::string> runs;
  std::string association = "interpolate", output, plots;
  run::ScoreOptions score;
  bool json = false, compare = false, report = false, quiet = false;
};

constexpr unsigned kScored =
    run::kTrajectory | run::kTruth | run::kKeyframes | run::kFrames | run::kMap;

Result<eval::Metrics> evaluate_folder(const std::string& name, const EvalCommand& command) {
  note_state(name);
  SGS_ASSIGN_OR_RETURN(const auto run, run::load_run(name, kScored));
  if (run.state.unfinished() && run.trajectory.empty()) {
    return fail(ErrorCode::kNotFound, fmt::format("{} has no frame yet", name),
                run.state.held ? "wait for it" : "it was killed: run it again");
  }
  SGS_ASSIGN_OR_RETURN(auto folder, run::RunFolder::open(name));
  SGS_ASSIGN_OR_RETURN(const auto scores, score_with_progress(run, command.score, command.quiet));
  if (interrupted()) {
    return fail(ErrorCode::kInterrupted, "scoring was cancelled: nothing was written");
  }
  if (run.state.held) {
    say("sgs: the scores of {} are shown only: it is not finished\n", name);
    return scores.metrics;
  }
  report::save_scores(run, scores, folder);
  if (!folder.failures().empty()) return tl::unexpected(folder.failures().front());
  return scores.metrics;
}

/// Name of a run folder, also of "." and "runs/latest/".
std::string folder_name(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(folder, error);
  return error || path.filename().empty() ? folder : path.filename().string();
}

/// --report: each run's page anew, from what its folder holds.
Status draw_reports(const EvalCommand& command) {
  for (const std::string& folder : command.runs) {
    note_state(folder);
    SGS_ASSIGN_OR_RETURN(const auto data, report::load_report(folder, command.score.association));
    const fs::path page = fs::path(folder) / run::files::kReport;
    SGS_RETURN_IF_ERROR(report::save_report(page, data));
    print("{}\n", page.string());
  }
  return {};
}

/// --compare and --plots: nothing is rendered, nothing in the run folders changes.
Status draw_runs(const EvalCommand& command) {
  std::vector<report::ReportData> runs;
  for (const std::string& folder : command.runs) {
    note_state(folder);
    SGS_ASSIGN_OR_RETURN(auto data, report::load_report(folder, command.score.association));
    data.label = folder_name(folder);
    runs.push_back(std::move(data));
  }
  if (!command.plots.empty()) {
    SGS_ASSIGN_OR_RETURN(const auto files,
                         report::save_drawings(command.plots, report::all_drawings(runs)));
    for (const fs::path& file : files) print("{}\n", file.string());
  }
  if (command.compare) {
    const fs::path output = command.output.empty() ? "report.html" : command.output;
    SGS_RETURN_IF_ERROR(report::save_comparison(output, runs));
    print("{}\n", output.string());
  }
  return {};
}

int run_eval(EvalCommand& command) {
  const auto association = eval::parse_association(command.association);
  if (!association) return report(association.error());
  command.score.association = *association;
  setup_logging({}, command.quiet);
  if (command.report || command.compare || !command.plots.empty()) {
    Status drawn = command.report ? draw_reports(command) : Status{};
    if (drawn && (command.compare || !command.plots.empty())) drawn = draw_runs(command);
    return drawn ? kExitDone : report(drawn.error());
  }
  std::vector<std::pair<std::string, eval::Metrics>> results;
  for (const std::string& folder : command.runs) {
    const auto metrics = evaluate_folder(folder, command);
    if (!metrics) return report(metrics.error());
    results.emplace_back(folder_name(folder), *metrics);
  }
  if (command.json) {
    std::string text;
    for (const auto& [name, metrics] : results) {
      text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ",\n", name, eval::to_json(metrics));
    }
    if (results.size() == 1) {
      print("{}\n", eval::to_json(results[0].second));
    } else {
      print("{{{}}}\n", text);
    }
  } else if (results.size() == 1) {
    print("{}", eval::metrics_table(results[0].second));
  } else {
    print("{}", eval::comparison_table(results));
  }
  return kExitDone;
}

}  // namespace

void add_eval(CLI::App& app, Action& action) {
  auto command = std::make_shared<EvalCommand>();
  auto* sub = app.add_subcommand("eval", "Compute the scores of finished runs again");
  sub->add_option("RUN", command->runs, "Run folders; several are compared")->required();
  sub->add_option("--association", command->association, "interpolate, nearest or nice-slam");
  add_score_options(*sub, command->score);
  sub->add_option("--threads", command->score.threads, "Threads")->check(CLI::Range(1, 256));
  auto* compare = sub->add_flag("--compare", command->compare,
                                "Write one page that compares the runs, from the scores they hold");
  sub->add_option("-o,--output", command->output, "With --compare: the page (default report.html)")
      ->needs(compare);
  sub->add_flag("--report", command->report,
                "Only draw RUN/report.html anew, from what the folder holds (needs no recording)");
  sub->add_option("--plots", command->plots,
                  "Write the report's plots as .svg files into this folder; several runs: the "
                  "plots that compare them");
  sub->add_flag("--quiet", command->quiet, "No progress");
  sub->add_flag("--json", command->json, "Print the metrics as JSON");
  sub->callback([command, &action] { action = [command] { return run_eval(*command); }; });
}

}  // namespace sgs::app
