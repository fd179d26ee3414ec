// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// `sgs bench` and `sgs sweep`: runs over a suite, as a table and as a plot.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <regex>

#include "commands.h"
#include "interrupt.h"
#include "sgs/core/print.h"
#include "sgs/io/atomic_file.h"
#include "sgs/suite/data_folder.h"
#include "sgs/suite/provenance.h"
#include "sgs/suite/runner.h"
#include "sgs/suite/slurm.h"
#include "sgs/suite/sweep.h"
#include "sgs/synthetic/scene_table.h"
#include "version.h"

namespace sgs::app {
namespace {

using suite::Job;

struct SuiteCommand {
  std::string suite = "tum-synth";
  std::string data;  ///< folder with the recordings of a benchmark
  suite::Options options;
  int at_a_time = 1;
  bool again = false;
  double lease_s = 120;
  std::string shard;  ///< I/N
  bool list = false, collect = false, sbatch = false;
};

const std::vector<int> kThreeSeeds = {1, 2, 3};
/// Of recordings, which have no noise to be drawn again.
const std::vector<int> kOneSeed = {1};

struct BenchCommand : SuiteCommand {
  std::vector<std::string> variants = {"spectral"};
  bool markdown = false, times = false, published = false;
};

struct SweepCommand : SuiteCommand {
  std::string range, variant = "paper";
  int per_octave = 1;
};

/// The runs of a suite, done as far as they could be.
struct Outcome {
  std::vector<Job> jobs;
  int exit_code = kExitDone;
  bool wants_table = true;
};

/// I/N of --shard.
Result<std::vector<Job>> shard_of(const std::vector<Job>& jobs, const std::string& text) {
  const auto bad = [&] {
    return fail(ErrorCode::kInvalidArgument, fmt::format("--shard '{}' is not I/N", text),
                "write I/N with I from 0 to N-1, for example 0/4");
  };
  static const std::regex form("([0-9]{1,6})/([0-9]{1,6})");
  std::smatch match;
  if (!std::regex_match(text, match, form)) return bad();
  const std::size_t index = std::stoul(match[1]), count = std::stoul(match[2]);
  if (index >= count) return bad();
  return suite::shard(jobs, index, count);
}

/// This command line without the options that share out the runs, the program by its whole path.
std::vector<std::string> sharable_words() {
  std::vector<std::string> words = suite::own_words();
  std::erase_if(words, [](const std::string& word) {
    return word == "--list" || word == "--sbatch" || word == "--collect";
  });
  words[0] = std::filesystem::read_symlink("/proc/self/exe").string();
  return words;
}

/// A line for each run: a command that makes it and no other.
void print_list(const std::vector<Job>& jobs) {
  const std::string command = suite::shell_command(sharable_words());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    print("{} --shard {}/{}  # {}\n", command, i, jobs.size(), jobs[i].name());
  }
}

void print_slurm_script(const SuiteCommand& command, const std::string& output, std::size_t runs) {
  constexpr int kThreadsOfARun = 2;  // the default of `sgs run`
  print("{}", suite::slurm_script({sharable_words(), std::filesystem::current_path(), output, runs,
                                   kThreadsOfARun * command.at_a_time}));
}

Status check_sharing(const SuiteCommand& command) {
  const int ways =
      int{command.list} + int{command.collect} + int{command.sbatch} + int{!command.shard.empty()};
  if (ways <= 1) return {};
  return fail(ErrorCode::kInvalidArgument,
              "--list, --shard, --collect and --sbatch exclude each other", "give one of them");
}

Result<Outcome> run_all(const suite::Suite& suite, const SuiteCommand& command,
                        const suite::Options& options) {
  Outcome outcome;
  SGS_RETURN_IF_ERROR(check_sharing(command));
  SGS_ASSIGN_OR_RETURN(outcome.jobs, suite::make_jobs(suite, options));
  if (command.list || command.sbatch) {
    outcome.wants_table = false;
    if (outcome.jobs.empty()) {
      return fail(ErrorCode::kInvalidArgument, "no run matches", "see --filter, --levels");
    }
    if (command.list) print_list(outcome.jobs);
    if (command.sbatch) print_slurm_script(command, options.output, outcome.jobs.size());
    return outcome;
  }
  if (command.collect) {
    const auto missing = std::count_if(outcome.jobs.begin(), outcome.jobs.end(),
                                       [](const Job& job) { return !job.is_done(); });
    if (missing == 0) return outcome;
    say("{} of {} runs are not done\n", missing, outcome.jobs.size());
    outcome.exit_code = kExitFailed;
    return outcome;
  }
  std::vector<Job> mine = outcome.jobs;
  if (!command.shard.empty()) {
    SGS_ASSIGN_OR_RETURN(mine, shard_of(outcome.jobs, command.shard));
    outcome.wants_table = false;
  }
  SGS_RETURN_IF_ERROR(io::make_folder(options.output));
  suite::Runner runner;
  runner.program = std::filesystem::read_symlink("/proc/self/exe").string();
  runner.interrupted = interrupted;
  runner.at_a_time = command.at_a_time;
  runner.again = command.again;
  runner.lease_s = command.lease_s;
  if (!runner.run(mine)) outcome.exit_code = kExitFailed;
  if (interrupted()) outcome.exit_code = kExitInterrupted;
  return outcome;
}

/// A suite with its recordings found, and what was to be seen of them.
struct FoundSuite {
  suite::Suite suite;
  std::vector<std::string> names;  ///< of all its sequences that --filter lets pass
  suite::Findings findings;
};

Result<FoundSuite> find_suite(const suite::Suite& loaded, const SuiteCommand& command,
                              const suite::Options& options) {
  FoundSuite out{loaded, {}, {}};
  SGS_ASSIGN_OR_RETURN(const std::vector<Job> all, suite::make_jobs(out.suite, options));
  for (const Job& job : all) {
    const bool known =
        std::find(out.names.begin(), out.names.end(), job.sequence) != out.names.end();
    if (!known) out.names.push_back(job.sequence);
  }
  SGS_ASSIGN_OR_RETURN(out.findings, suite::find_recordings(command.data, out.suite));
  for (const std::string& line : out.findings.found) say("found {}\n", line);
  return out;
}

std::vector<suite::Table> bench_tables(const BenchCommand& command, const suite::Suite& suite,
                                       const suite::Grid& grid) {
  suite::Table table = suite::ate_table(
      grid,
      "ATE RMSE in cm, mean (worst) over seeds; share of frames within 1 m where below 100 %");
  suite::add_publications(suite.publications, table);
  std::vector<suite::Table> tables = {std::move(table)};
  if (command.published || suite.benchmark) {
    for (suite::Table& more : suite::published_tables(grid, suite.publications)) {
      tables.push_back(std::move(more));
    }
  }
  if (command.times) {
    tables.push_back(suite::times_table(
        grid, "frames per second / 95th percentile of tracking in ms, mean over seeds"));
  }
  return tables;
}

void print_tables(const std::vector<suite::Table>& tables, bool markdown) {
  if (markdown) print("{}\n", suite::provenance(version_and_commit()));
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (markdown || i > 0) print("\n");
    print("{}", markdown ? as_markdown(tables[i]) : as_text(tables[i]));
  }
}

/// How long what was run is: a part of a recording is not to be compared with the whole.
void print_lengths(const suite::Grid& grid) {
  std::vector<std::string> lengths;
  for (const std::string& name : grid.columns) {
    for (const std::string& row : grid.rows) {
      const auto runs = grid.at(row, name);
      if (name == suite::Publication::kAverage || runs.empty() || !runs.front().frames) continue;
      lengths.push_back(fmt::format("{} {}", name, *runs.front().frames));
      break;
    }
  }
  if (!lengths.empty()) print("\nFrames: {}\n", fmt::format("{}", fmt::join(lengths, ", ")));
}

void print_missing(const suite::Findings& findings, bool markdown) {
  if (findings.missing.empty()) return;
  print("\nNot run:\n{}", markdown ? "\n" : "");
  for (const std::string& line : findings.missing) print("{}{}\n", markdown ? "- " : "  ", line);
}

Result<int> run_bench(const BenchCommand& command) {
  SGS_ASSIGN_OR_RETURN(const suite::Suite loaded, suite::load_suite(command.suite));
  suite::Options options = command.options;
  if (options.output.empty()) options.output = "runs/bench-" + loaded.name;
  if (options.seeds.empty()) options.seeds = loaded.benchmark ? kOneSeed : kThreeSeeds;
  options.rendering = options.rendering || loaded.benchmark;
  for (const std::string& name : command.variants) {
    SGS_ASSIGN_OR_RETURN(options.variants.emplace_back(), loaded.variant(name));
  }
  SGS_ASSIGN_OR_RETURN(const FoundSuite found, find_suite(loaded, command, options));
  SGS_ASSIGN_OR_RETURN(const Outcome outcome, run_all(found.suite, command, options));
  if (!outcome.wants_table) return outcome.exit_code;
  suite::Grid grid = suite::collect(
      outcome.jobs, [](const Job& job) { return job.level + " " + job.variant; },
      [](const Job& job) { return job.sequence; });
  if (loaded.benchmark) suite::complete(loaded, found.names, grid);
  print_tables(bench_tables(command, found.suite, grid), command.markdown);
  print("{}", suite::processors_line(grid));
  if (loaded.benchmark) print_lengths(grid);
  print_missing(found.findings, command.markdown);
  return outcome.exit_code;
}

Result<int> run_sweep(const SweepCommand& command) {
  SGS_ASSIGN_OR_RETURN(suite::Suite suite, suite::load_suite(command.suite));
  SGS_ASSIGN_OR_RETURN(const suite::Findings findings, suite::find_recordings(command.data, suite));
  for (const std::string& line : findings.missing) say("not run: {}\n", line);
  SGS_ASSIGN_OR_RETURN(const suite::Range range,
                       suite::parse_range(command.range, command.per_octave, suite.aliases));
  SGS_ASSIGN_OR_RETURN(const suite::Variant base, suite.variant(command.variant));
  suite::Options options = command.options;
  if (options.output.empty()) options.output = "runs/sweep-" + suite.name;
  options.variants = suite::swept_variants(base, range);
  SGS_ASSIGN_OR_RETURN(const Outcome outcome, run_all(suite, command, options));
  if (!outcome.wants_table) return outcome.exit_code;
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
  sub.add_option("--data", command.data,
                 "Folder with the recordings of a benchmark: what lies there is run");
  sub.add_option("--trajectories", options.trajectories,
                 "Folder with TUM sequences: fly along their ground truth");
  sub.add_option("--cache", options.cache,
                 "Folder that keeps the rendered sequences: each is rendered once for all runs");
  sub.add_option("--filter", options.filter, "Only runs SEQUENCE-LEVEL-VARIANT-SEED that match");
  sub.add_option("--levels", options.levels, "clean, kinect, hard, varied, real")
      ->delimiter(',')
      ->check([](const std::string& level) {
        const auto known = synthetic::check_level(level);
        return known ? std::string() : known.error().text();
      });
  sub.add_option("--seeds", options.seeds,
                 "Seeds of scene, noise and mapper [bench: 1,2,3, of a benchmark 1]")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
  sub.add_option("--set", options.assignments, "key=value for every run")->allow_extra_args(false);
  sub.add_option("--frames", options.frames, "At most so many frames per sequence; 0 = all")
      ->check(CLI::NonNegativeNumber);
  sub.add_option("--jobs", command.at_a_time, "Runs at a time")->check(CLI::Range(1, 64));
  sub.add_flag("--rendering", options.rendering, "Also compute the rendering scores");
  sub.add_option("--lpips-weights", options.lpips_weights,
                 "LPIPS-Alex v0.1 weights, for LPIPS among the rendering scores");
  sub.add_option("--lease", command.lease_s,
                 "A worker that gave no sign of life for so many seconds is taken for dead")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  sub.add_option("--shard", command.shard,
                 "I/N: only every N-th run from the I-th on, and no table (docs/cluster.md)");
  sub.add_flag("--list", command.list, "Run nothing; print a command for each run");
  sub.add_flag("--collect", command.collect, "Run nothing; print the table of what is done");
  sub.add_flag("--sbatch", command.sbatch, "Run nothing; print a script that submits all to Slurm");
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
  auto* sub = app.add_subcommand("bench", "Run a suite of sequences and print one table");
  sub->add_option("SUITE", command->suite,
                  "tum-synth, tum, replica, or a FILE.toml (docs/suites.md)");
  sub->add_option("--variants", command->variants, "Trackers and ablations (docs/suites.md)")
      ->delimiter(',');
  sub->add_flag("--published", command->published,
                "Also tables of picture quality and speed beside what others published");
  sub->add_flag("--markdown", command->markdown,
                "Print Markdown, with command, version, machine and date");
  sub->add_flag("--times", command->times, "Also a table of times, by processor");
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
  sub->add_option("--suite", command->suite,
                  "tum-synth, tum, replica, or a FILE.toml (docs/suites.md)");
  sub->add_option("--variant", command->variant, "What is swept, one of bench's --variants");
  sub->add_option("--per-octave", command->per_octave, "Values per doubling")
      ->check(CLI::Range(1, 16));
  add_suite_options(*sub, *command);
  sub->callback([command, &action] { action = action_of(run_sweep, command); });
}

}  // namespace sgs::app
