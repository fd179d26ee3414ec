// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <regex>
#include <thread>

#include "commands.h"
#include "interrupt.h"
#include "sgs/eval/metrics.h"
#include "sgs/io/atomic_file.h"
#include "suite.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct BenchCommand {
  std::string suite = "tum-synth", output = "runs/bench-tum-synth", trajectories, filter = ".*";
  std::vector<std::string> levels = {"kinect"}, trackers = {"gicp"}, presets = {"default"};
  std::vector<int> seeds = {1, 2, 3};
  std::vector<std::string> assignments;
  int jobs = 1, frames = 0;
  bool rendering = false, again = false;
};

std::vector<SuiteJob> make_jobs(const BenchCommand& command) {
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  const std::regex filter(command.filter);
  std::vector<SuiteJob> jobs;
  for (const std::string& level : command.levels)
    for (const SuiteSequence& sequence : tum_synth_suite())
      for (const std::string& tracker : command.trackers)
        for (const std::string& preset : command.presets)
          for (const int seed : command.seeds) {
            SuiteJob job{sequence.name, level, tracker + "/" + preset, seed, "", {}};
            const std::string id =
                fmt::format("{}-{}-{}-{}-{}", sequence.name, level, tracker, preset, seed);
            if (!std::regex_search(id, filter)) continue;
            job.folder = (fs::path(command.output) / id).string();
            job.arguments = {program,
                             "run",
                             fmt::format("synth:{}:{}", sequence.scene, level),
                             "-o",
                             job.folder,
                             "--tracker",
                             tracker,
                             "--preset",
                             preset,
                             "--seed",
                             std::to_string(seed),
                             "--synth-seed",
                             std::to_string(seed),
                             "--quiet"};
            const fs::path truth =
                fs::path(command.trajectories) / sequence.trajectory / "groundtruth.txt";
            if (!command.trajectories.empty() && !sequence.trajectory.empty()) {
              job.arguments.insert(job.arguments.end(), {"--trajectory", truth.string()});
            }
            if (!command.rendering) job.arguments.push_back("--no-eval");
            if (command.frames > 0) {
              job.arguments.insert(job.arguments.end(),
                                   {"--frames", fmt::format("0:{}", command.frames)});
            }
            for (const std::string& assignment : command.assignments) {
              job.arguments.insert(job.arguments.end(), {"--set", assignment});
            }
            jobs.push_back(job);
          }
  return jobs;
}

bool is_done(const SuiteJob& job) {
  std::error_code error;
  return fs::exists(fs::path(job.folder) / "metrics.json", error);
}

/// Runs what is missing, several at a time. Every run leaves its own folder, so that an interrupted
/// suite goes on where it was.
void run_jobs(const std::vector<SuiteJob>& jobs, const BenchCommand& command) {
  std::atomic<std::size_t> next{0};
  std::mutex print;
  const auto worker = [&] {
    for (std::size_t i = next++; i < jobs.size() && !interrupted(); i = next++) {
      const SuiteJob& job = jobs[i];
      if (is_done(job) && !command.again) continue;
      std::error_code error;
      fs::create_directories(job.folder, error);
      const auto code = run_program(job.arguments, (fs::path(job.folder) / "console.txt").string());
      const std::scoped_lock lock(print);
      fmt::print(stderr, "[{}/{}] {} {}\n", i + 1, jobs.size(), job.folder,
                 code ? fmt::format("exit {}", *code) : code.error().text());
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < command.jobs; ++i) threads.emplace_back(worker);
  for (std::thread& thread : threads) thread.join();
}

/// "mean (worst)" of the ATE in cm over seeds, with the lowest share of tracked frames when it is
/// not all of them.
std::string cell(const std::vector<eval::Metrics>& runs) {
  double sum = 0, worst = 0, tracked = 100;
  int count = 0;
  for (const eval::Metrics& m : runs) {
    if (m.frames && m.frames_tracked && *m.frames > 0) {
      tracked = std::min(
          tracked, 100.0 * static_cast<double>(*m.frames_tracked) / static_cast<double>(*m.frames));
    }
    if (!m.ate_rmse_m) continue;
    sum += 100 * *m.ate_rmse_m;
    worst = std::max(worst, 100 * *m.ate_rmse_m);
    ++count;
  }
  if (count == 0) return "-";
  std::string text = fmt::format("{:.2f} ({:.2f})", sum / count, worst);
  if (tracked < 99.95) text += fmt::format(" {:.0f}%", tracked);
  return text;
}

void print_row(const std::string& name, const std::vector<std::string>& cells) {
  fmt::print("{:<26}", name);
  for (const std::string& text : cells) fmt::print(" {:>17}", text);
  fmt::print("\n");
}

void print_table(const std::vector<SuiteJob>& jobs) {
  std::map<std::pair<std::string, std::string>, std::map<std::string, std::vector<eval::Metrics>>>
      results;
  std::vector<std::string> sequences;
  for (const SuiteJob& job : jobs) {
    if (std::find(sequences.begin(), sequences.end(), job.sequence) == sequences.end()) {
      sequences.push_back(job.sequence);
    }
    auto& runs = results[{job.level, job.variant}][job.sequence];
    if (!is_done(job)) continue;
    if (auto m = eval::load_metrics(fs::path(job.folder) / "metrics.json")) runs.push_back(*m);
  }
  fmt::print(
      "ATE RMSE in cm, mean (worst) over seeds; share of frames tracked where below 100 %\n");
  print_row("", sequences);
  for (auto& [key, row] : results) {
    std::vector<std::string> cells;
    for (const std::string& name : sequences) cells.push_back(cell(row[name]));
    print_row(key.first + " " + key.second, cells);
  }
  fmt::print("published, on the real sequences\n");
  for (const PublishedRow& row : published_results()) {
    std::vector<std::string> cells;
    for (const std::string& name : sequences) {
      const auto it = std::find_if(row.ate_cm.begin(), row.ate_cm.end(),
                                   [&](const auto& entry) { return entry.first == name; });
      cells.push_back(it == row.ate_cm.end() ? ""
                      : it->second < 0       ? "lost"
                                             : fmt::format("{:.2f}", it->second));
    }
    print_row(row.system, cells);
  }
}

int run_bench(const BenchCommand& command) {
  std::vector<SuiteJob> jobs;
  try {
    jobs = make_jobs(command);
  } catch (const std::regex_error& error) {
    return report({ErrorCode::kInvalidArgument,
                   fmt::format("--filter '{}': {}", command.filter, error.what()),
                   "use an ECMAScript regular expression"});
  }
  if (const auto made = io::make_folder(command.output); !made) return report(made.error());
  run_jobs(jobs, command);
  print_table(jobs);
  return interrupted() ? kExitInterrupted : kExitDone;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  auto command = std::make_shared<BenchCommand>();
  auto* sub = app.add_subcommand("bench", "Run a suite of sequences and print one table");
  sub->add_option("SUITE", command->suite, "tum-synth")->check(CLI::IsMember({"tum-synth"}));
  sub->add_option("-o,--output", command->output, "Folder with one run folder per run; resumable");
  sub->add_option("--trajectories", command->trajectories,
                  "Folder with TUM sequences: fly along their ground truth");
  sub->add_option("--filter", command->filter,
                  "Only runs SEQUENCE-LEVEL-TRACKER-PRESET-SEED that match");
  sub->add_option("--levels", command->levels, "clean, kinect, hard")->delimiter(',');
  sub->add_option("--trackers", command->trackers, "Trackers")->delimiter(',');
  sub->add_option("--presets", command->presets, "Presets")->delimiter(',');
  sub->add_option("--seeds", command->seeds, "Seeds of scene, noise and mapper")->delimiter(',');
  sub->add_option("--set", command->assignments, "key=value for every run")
      ->allow_extra_args(false);
  sub->add_option("--frames", command->frames, "At most so many frames per sequence");
  sub->add_option("--jobs", command->jobs, "Runs at a time")->check(CLI::Range(1, 64));
  sub->add_flag("--rendering", command->rendering, "Also compute the rendering scores");
  sub->add_flag("--again", command->again, "Repeat runs that are already done");
  sub->callback([command, sub, &action] {
    if (sub->get_subcommands().empty()) action = [command] { return run_bench(*command); };
  });
}

}  // namespace sgs::app
