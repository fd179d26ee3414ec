// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "commands.h"
#include "sgs/synthetic/scene_table.h"
#include "suite.h"

namespace sgs::app {
namespace {

struct BenchCommand {
  std::string suite = "tum-synth";
  std::vector<std::string> variants = {"spectral"};
  SuiteOptions options;
};

void print_row(const std::string& name, const std::vector<std::string>& cells) {
  fmt::print("{:<26}", name);
  for (const std::string& text : cells) fmt::print(" {:>17}", text);
  fmt::print("\n");
}

/// What others published of these sequences; nothing where nobody did.
void print_published(const std::vector<std::string>& sequences) {
  bool headed = false;
  for (const PublishedRow& row : published_results()) {
    std::vector<std::string> cells;
    bool any = false;
    for (const std::string& name : sequences) {
      const auto it = std::find_if(row.ate_cm.begin(), row.ate_cm.end(),
                                   [&](const auto& entry) { return entry.first == name; });
      cells.push_back(it == row.ate_cm.end() ? ""
                      : it->second < 0       ? "lost"
                                             : fmt::format("{:.2f}", it->second));
      any = any || it != row.ate_cm.end();
    }
    if (!any) continue;
    if (!headed) fmt::print("published, on the real sequences\n");
    headed = true;
    print_row(row.system, cells);
  }
}

void print_table(const std::vector<SuiteJob>& jobs) {
  std::vector<std::string> sequences, rows;
  std::map<std::string, std::map<std::string, std::vector<eval::Metrics>>> results;
  const auto add_once = [](std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const SuiteJob& job : jobs) {
    const std::string row = job.level + " " + job.variant;
    add_once(sequences, job.sequence);
    add_once(rows, row);
    if (auto m = job_metrics(job)) results[row][job.sequence].push_back(*m);
  }
  fmt::print(
      "ATE RMSE in cm, mean (worst) over seeds; share of frames within 1 m where below 100 %\n");
  print_row("", sequences);
  for (const std::string& row : rows) {
    std::vector<std::string> cells;
    for (const std::string& name : sequences) cells.push_back(ate_cell(results[row][name]));
    print_row(row, cells);
  }
  print_published(sequences);
}

int run_bench(const BenchCommand& command) {
  SuiteOptions options = command.options;
  for (const std::string& name : command.variants) {
    const auto variant = find_variant(name);
    if (!variant) return report(variant.error());
    options.variants.push_back(*variant);
  }
  const auto outcome = run_suite(options);
  if (!outcome) return report(outcome.error());
  print_table(outcome->jobs);
  return outcome->exit_code();
}

}  // namespace

void add_suite_options(CLI::App& sub, SuiteOptions& options) {
  sub.add_option("-o,--output", options.output, "Folder with one run folder per run; resumable");
  sub.add_option("--trajectories", options.trajectories,
                 "Folder with TUM sequences: fly along their ground truth");
  sub.add_option("--cache", options.cache,
                 "Folder that keeps the rendered sequences: each is rendered once for all runs");
  sub.add_option("--filter", options.filter, "Only runs SEQUENCE-LEVEL-VARIANT-SEED that match");
  sub.add_option("--levels", options.levels, "clean, kinect, hard")
      ->delimiter(',')
      ->check([](const std::string& level) {
        const auto known = synthetic::check_level(level);
        return known ? std::string() : known.error().text();
      });
  sub.add_option("--seeds", options.seeds, "Seeds of scene, noise and mapper")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  sub.add_option("--set", options.assignments, "key=value for every run")->allow_extra_args(false);
  sub.add_option("--frames", options.frames, "At most so many frames per sequence; 0 = all")
      ->check(CLI::NonNegativeNumber);
  sub.add_option("--jobs", options.jobs, "Runs at a time")->check(CLI::Range(1, 64));
  sub.add_flag("--rendering", options.rendering, "Also compute the rendering scores");
  sub.add_flag("--again", options.again, "Repeat runs that are already done");
}

void add_bench(CLI::App& app, Action& action) {
  auto command = std::make_shared<BenchCommand>();
  command->options.output = "runs/bench-tum-synth";
  command->options.levels = {"kinect"};
  command->options.seeds = {1, 2, 3};
  auto* sub = app.add_subcommand("bench", "Run a suite of sequences and print one table");
  sub->add_option("SUITE", command->suite, "tum-synth")->check(CLI::IsMember({"tum-synth"}));
  std::string names;
  for (const SuiteVariant& v : suite_variants()) names += (names.empty() ? "" : ", ") + v.name;
  sub->add_option("--variants", command->variants, "Trackers and ablations: " + names)
      ->delimiter(',');
  add_suite_options(*sub, command->options);
  sub->callback([command, sub, &action] {
    if (sub->get_subcommands().empty()) action = [command] { return run_bench(*command); };
  });
}

}  // namespace sgs::app
