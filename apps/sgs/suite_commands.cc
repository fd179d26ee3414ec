// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `sgs bench` and `sgs sweep`: runs over a suite, as a table and as a plot.

#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "interrupt.h"
#include "sgs/core/print.h"
#include "sgs/io/atomic_file.h"
#include "sgs/suite/provenance.h"
#include "sgs/suite/runner.h"
#include "sgs/suite/sweep.h"
#include "sgs/synthetic/scene_table.h"
#include "version.h"

namespace sgs::app {
namespace {

using suite::Job;

struct SuiteCommand {
  std::string suite = "tum-synth";
  suite::Options options;
  int at_a_time = 1;
  bool again = false;
};

struct BenchCommand : SuiteCommand {
  std::vector<std::string> variants = {"spectral"};
  bool markdown = false;
};

struct SweepCommand : SuiteCommand {
  std::string range, variant = "paper";
  int per_octave = 1;
};

/// The runs of a suite, done as far as they could be.
struct Outcome {
  std::vector<Job> jobs;
  int exit_code = kExitDone;
};

Result<Outcome> run_all(const suite::Suite& suite, const SuiteCommand& command,
                        const suite::Options& options) {
  Outcome outcome;
  SGS_ASSIGN_OR_RETURN(outcome.jobs, suite::make_jobs(suite, options));
  SGS_RETURN_IF_ERROR(io::make_folder(options.output));
  const suite::Runner runner{std::filesystem::read_symlink("/proc/self/exe").string(), interrupted,
                             command.at_a_time, command.again};
  if (!runner.run(outcome.jobs)) outcome.exit_code = kExitFailed;
  if (interrupted()) outcome.exit_code = kExitInterrupted;
  return outcome;
}

Result<int> run_bench(const BenchCommand& command) {
  SGS_ASSIGN_OR_RETURN(const suite::Suite suite, suite::load_suite(command.suite));
  suite::Options options = command.options;
  if (options.output.empty()) options.output = "runs/bench-" + suite.name;
  for (const std::string& name : command.variants) {
    SGS_ASSIGN_OR_RETURN(options.variants.emplace_back(), suite.variant(name));
  }
  SGS_ASSIGN_OR_RETURN(const Outcome outcome, run_all(suite, command, options));
  const suite::Grid grid = suite::collect(
      outcome.jobs, [](const Job& job) { return job.level + " " + job.variant; },
      [](const Job& job) { return job.sequence; });
  suite::Table table = suite::ate_table(
      grid,
      "ATE RMSE in cm, mean (worst) over seeds; share of frames within 1 m where below 100 %");
  suite::add_publications(suite.publications, table);
  if (command.markdown) {
    print("{}\n\n{}", suite::provenance(version_and_commit()), as_markdown(table));
  } else {
    print("{}", as_text(table));
  }
  return outcome.exit_code;
}

Result<int> run_sweep(const SweepCommand& command) {
  SGS_ASSIGN_OR_RETURN(const suite::Suite suite, suite::load_suite(command.suite));
  SGS_ASSIGN_OR_RETURN(const suite::Range range,
                       suite::parse_range(command.range, command.per_octave, suite.aliases));
  SGS_ASSIGN_OR_RETURN(const suite::Variant base, suite.variant(command.variant));
  suite::Options options = command.options;
  if (options.output.empty()) options.output = "runs/sweep-" + suite.name;
  options.variants = suite::swept_variants(base, range);
  SGS_ASSIGN_OR_RETURN(const Outcome outcome, run_all(suite, command, options));
  const suite::Grid grid = suite::collect(
      outcome.jobs, [](const Job& job) { return job.variant; },
      [](const Job& job) { return job.sequence + " " + job.level; });
  const std::string title =
      fmt::format("{} of `{}`: ATE RMSE in cm, mean (worst) over seeds", range.key, base.name);
  print("{}", as_text(suite::ate_table(grid, title)));
  const auto plot = std::filesystem::path(options.output) / "sweep.svg";
  SGS_RETURN_IF_ERROR(io::write_file(plot, suite::sweep_plot(grid, range.key)));
  print("{}\n", plot.string());
  return outcome.exit_code;
}

void add_suite_options(CLI::App& sub, SuiteCommand& command) {
  suite::Options& options = command.options;
  sub.add_option("-o,--output", options.output,
                 "Folder with one run folder per run; resumable [runs/COMMAND-SUITE]");
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
  sub.add_option("--jobs", command.at_a_time, "Runs at a time")->check(CLI::Range(1, 64));
  sub.add_flag("--rendering", options.rendering, "Also compute the rendering scores");
  sub.add_flag("--again", command.again, "Repeat runs that are already done");
}

template <class Command>
Action action_of(Result<int> (*run)(const Command&), std::shared_ptr<Command> command) {
  return [run, command] {
    const Result<int> code = run(*command);
    return code ? *code : report(code.error());
  };
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  auto command = std::make_shared<BenchCommand>();
  command->options.levels = {"kinect"};
  command->options.seeds = {1, 2, 3};
  auto* sub = app.add_subcommand("bench", "Run a suite of sequences and print one table");
  sub->add_option("SUITE", command->suite, "tum-synth, or a FILE.toml (docs/suites.md)");
  sub->add_option("--variants", command->variants, "Trackers and ablations (docs/suites.md)")
      ->delimiter(',');
  sub->add_flag("--markdown", command->markdown,
                "Print Markdown, with command, version, machine and date");
  add_suite_options(*sub, *command);
  sub->callback([command, &action] { action = action_of(run_bench, command); });
}

void add_sweep(CLI::App& app, Action& action) {
  auto command = std::make_shared<SweepCommand>();
  command->options.levels = {"kinect"};
  command->options.seeds = {1};
  command->options.filter = "^(nostruct|notex)";
  auto* sub = app.add_subcommand("sweep", "Run a suite over a range of one parameter, plot it");
  sub->add_option("RANGE", command->range,
                  "KEY=A:B in doublings; KEY is a parameter or an alias, e.g. tau_deg")
      ->required();
  sub->add_option("--suite", command->suite, "tum-synth, or a FILE.toml (docs/suites.md)");
  sub->add_option("--variant", command->variant, "What is swept, one of bench's --variants");
  sub->add_option("--per-octave", command->per_octave, "Values per doubling")
      ->check(CLI::Range(1, 16));
  add_suite_options(*sub, *command);
  sub->callback([command, &action] { action = action_of(run_sweep, command); });
}

}  // namespace sgs::app
