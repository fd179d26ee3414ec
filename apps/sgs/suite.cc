// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "suite.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <regex>
#include <set>
#include <thread>

#include "commands.h"
#include "interrupt.h"
#include "sgs/io/atomic_file.h"

extern char** environ;

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

// Runs a program and waits for it; its output goes to `log_file`. Returns the exit code.
Result<int> run_program(const std::vector<std::string>& arguments, const std::string& log_file) {
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failed = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    return fail(ErrorCode::kIo, fmt::format("cannot start {}: {}", arguments[0], strerror(failed)));
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Lies in a run's folder until it has ended well: an interrupted run leaves scores too.
fs::path unfinished_mark(const SuiteJob& job) { return fs::path(job.folder) / "unfinished"; }

bool is_done(const SuiteJob& job) {
  std::error_code error;
  return fs::exists(fs::path(job.folder) / "metrics.json", error) &&
         !fs::exists(unfinished_mark(job), error);
}

bool is_rendered(const SuiteJob& job) {
  std::error_code error;
  return job.rendered.empty() || fs::exists(job.rendered, error);
}

/// Calls `work(i)` for 0 <= i < count from `threads` threads until the user interrupts.
template <class Work>
void in_parallel(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto worker = [&] {
    for (std::size_t i = next++; i < count && !interrupted(); i = next++) work(i);
  };
  std::vector<std::thread> pool;
  for (int i = 0; i < threads; ++i) pool.emplace_back(worker);
  for (std::thread& thread : pool) thread.join();
}

/// The last line that a program wrote; empty where there is none.
std::string last_line(const std::string& log_file) {
  std::ifstream file(log_file);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

/// Runs that lost track have scores too.
bool succeeded(const Result<int>& code) {
  return code && (*code == kExitDone || *code == kExitLost);
}

std::string outcome_text(const Result<int>& code, const std::string& log_file) {
  if (!code) return code.error().text();
  const std::string reason = succeeded(code) ? "" : last_line(log_file);
  return fmt::format("exit {}{}{}", *code, reason.empty() ? "" : ": ", reason);
}

SuiteJob make_job(const SuiteOptions& options, const SuiteSequence& sequence,
                  const std::string& level, const SuiteVariant& variant, int seed) {
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  const std::string scene = fmt::format("{}:{}", sequence.scene, level);
  SuiteJob job{sequence.name, level, variant.name, seed, "", {}, "", {}};
  job.folder = (fs::path(options.output) /
                fmt::format("{}-{}-{}-{}", sequence.name, level, variant.name, seed))
                   .string();
  std::vector<std::string> motion = {"--synth-seed", std::to_string(seed)};
  const fs::path truth = fs::path(options.trajectories) / sequence.trajectory / "groundtruth.txt";
  const bool flies_along = !options.trajectories.empty() && !sequence.trajectory.empty();
  if (flies_along) motion.insert(motion.end(), {"--trajectory", truth.string()});
  if (options.cache.empty()) {
    job.arguments = {program, "run", "synth:" + scene};
    job.arguments.insert(job.arguments.end(), motion.begin(), motion.end());
  } else {
    const std::string name = fmt::format("{}-{}-{}", sequence.name, level, seed);
    job.rendered = (fs::path(options.cache) / name).string();
    job.arguments = {program, "run", job.rendered};
    job.render_arguments = {program,  "synth",   scene,    job.rendered + ".part",
                            "--seed", motion[1], "--quiet"};
    if (flies_along) {
      job.render_arguments.insert(job.render_arguments.end(), {"--trajectory", truth.string()});
    }
  }
  job.arguments.insert(job.arguments.end(),
                       {"-o", job.folder, "--seed", std::to_string(seed), "--quiet"});
  job.arguments.insert(job.arguments.end(), variant.arguments.begin(), variant.arguments.end());
  if (!options.rendering) job.arguments.push_back("--no-eval");
  if (options.frames > 0) {
    job.arguments.insert(job.arguments.end(), {"--frames", fmt::format("0:{}", options.frames)});
  }
  for (const std::string& assignment : options.assignments) {
    job.arguments.insert(job.arguments.end(), {"--set", assignment});
  }
  return job;
}

/// Renders what the jobs need, each sequence once; a half-rendered one is never mistaken for whole.
/// Returns whether all went well.
bool render_missing(const std::vector<SuiteJob>& jobs, int threads) {
  std::set<std::string> seen;
  std::vector<const SuiteJob*> missing;
  for (const SuiteJob& job : jobs) {
    if (!is_rendered(job) && seen.insert(job.rendered).second) missing.push_back(&job);
  }
  std::mutex print;
  std::atomic<bool> well{true};
  in_parallel(missing.size(), threads, [&](std::size_t i) {
    const SuiteJob& job = *missing[i];
    std::error_code error;
    fs::create_directories(fs::path(job.rendered).parent_path(), error);
    fs::remove_all(job.rendered + ".part", error);
    const std::string log = job.rendered + ".log";
    const auto code = run_program(job.render_arguments, log);
    const std::scoped_lock lock(print);
    fmt::print(stderr, "[rendered {}/{}] {} {}\n", i + 1, missing.size(), job.rendered,
               outcome_text(code, log));
    if (code && *code == kExitDone) {
      fs::rename(job.rendered + ".part", job.rendered, error);
      fs::remove(log, error);
    } else {
      well = false;
    }
  });
  return well;
}

std::vector<SuiteJob> make_jobs(const SuiteOptions& options, const std::regex& filter) {
  std::vector<SuiteJob> jobs;
  for (const std::string& level : options.levels)
    for (const SuiteSequence& sequence : tum_synth_suite())
      for (const SuiteVariant& variant : options.variants)
        for (const int seed : options.seeds) {
          SuiteJob job = make_job(options, sequence, level, variant, seed);
          if (std::regex_search(fs::path(job.folder).filename().string(), filter)) {
            jobs.push_back(std::move(job));
          }
        }
  return jobs;
}

/// Runs what is missing; returns whether all went well.
bool run_jobs(const std::vector<SuiteJob>& jobs, const SuiteOptions& options) {
  std::vector<SuiteJob> missing;
  std::copy_if(jobs.begin(), jobs.end(), std::back_inserter(missing),
               [&](const SuiteJob& job) { return options.again || !is_done(job); });
  if (missing.size() < jobs.size()) {
    fmt::print(stderr, "{} of {} runs were done before (--again repeats them)\n",
               jobs.size() - missing.size(), jobs.size());
  }
  std::atomic<bool> well{render_missing(missing, options.jobs)};
  std::mutex print;
  in_parallel(missing.size(), options.jobs, [&](std::size_t i) {
    const SuiteJob& job = missing[i];
    if (!is_rendered(job)) return;
    std::error_code error;
    fs::create_directories(job.folder, error);
    std::ofstream(unfinished_mark(job)).flush();
    const std::string log = (fs::path(job.folder) / "console.txt").string();
    const auto code = run_program(job.arguments, log);
    if (succeeded(code)) {
      fs::remove(unfinished_mark(job), error);
    } else {
      well = false;
    }
    const std::scoped_lock lock(print);
    fmt::print(stderr, "[{}/{}] {} {}\n", i + 1, missing.size(), job.folder,
               outcome_text(code, log));
  });
  return well;
}

}  // namespace

const std::vector<SuiteSequence>& tum_synth_suite() {
  static const std::vector<SuiteSequence> suite = {
      {"nostruct_near", "nostructure_texture_near",
       "rgbd_dataset_freiburg3_nostructure_texture_near_withloop"},
      {"nostruct_far", "nostructure_texture_far", "rgbd_dataset_freiburg3_nostructure_texture_far"},
      {"notex_near", "structure_notexture_near", "rgbd_dataset_freiburg3_structure_notexture_near"},
      {"notex_far", "structure_notexture_far", "rgbd_dataset_freiburg3_structure_notexture_far"},
      {"struct_tex_near", "structure_texture_near",
       "rgbd_dataset_freiburg3_structure_notexture_near"},
      {"room_desk", "room_desk", "rgbd_dataset_freiburg1_desk"},
      {"office", "office", "rgbd_dataset_freiburg3_long_office_household"},
      {"corridor", "corridor", ""},
      {"fold", "fold", ""},
      {"dual", "dual", ""},
  };
  return suite;
}

const std::vector<PublishedRow>& published_results() {
  static const std::vector<PublishedRow> rows = {
      {"SplaTAM",
       {{"nostruct_near", 4.49},
        {"nostruct_far", 9.49},
        {"notex_near", 2.27},
        {"notex_far", 4.54}}},
      {"MonoGS",
       {{"nostruct_near", 11.86},
        {"nostruct_far", 4.10},
        {"notex_near", 26.91},
        {"notex_far", 10.39}}},
      {"Photo-SLAM",
       {{"nostruct_near", 2.27}, {"nostruct_far", 5.36}, {"notex_near", -1}, {"notex_far", -1}}},
      {"GS-ICP SLAM",
       {{"nostruct_near", 194.93},
        {"nostruct_far", 116.16},
        {"notex_near", 1.55},
        {"notex_far", 6.07}}},
      {"Spectral GS-SLAM (paper)",
       {{"nostruct_near", 7.79},
        {"nostruct_far", 16.85},
        {"notex_near", 1.55},
        {"notex_far", 2.19}}},
  };
  return rows;
}

const std::vector<SuiteVariant>& suite_variants() {
  const auto paper = [](std::vector<std::string> assignments) {
    std::vector<std::string> arguments = {"--preset", "paper"};
    for (std::string& assignment : assignments) {
      arguments.insert(arguments.end(), {"--set", std::move(assignment)});
    }
    return arguments;
  };
  static const std::vector<SuiteVariant> variants = {
      {"spectral", {"--tracker", "spectral"}},
      {"gicp", {"--tracker", "gicp"}},
      {"orb", {"--tracker", "orb"}},
      {"cvm", {"--tracker", "cvm"}},
      {"joint", {"--tracker", "spectral", "--set", "tracker.fusion=joint"}},
      {"paper", paper({})},
      {"paper-hard-gate", paper({"tracker.degeneracy.soft_gate=false"})},
      {"paper-no-planarity", paper({"tracker.prior.planarity=false"})},
      {"paper-scale", paper({"tracker.target.scale_sigmas=1"})},
      {"paper-prior-only", paper({"tracker.prior.only=true"})},
      {"paper-cvm", paper({"tracker.prior.source=cvm"})},
  };
  return variants;
}

Result<SuiteVariant> find_variant(const std::string& name) {
  std::string names;
  for (const SuiteVariant& variant : suite_variants()) {
    if (variant.name == name) return variant;
    names += (names.empty() ? "" : ", ") + variant.name;
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("no variant '{}'", name),
              "there are " + names);
}

int SuiteOutcome::exit_code() const {
  if (interrupted()) return kExitInterrupted;
  return failed ? kExitFailed : kExitDone;
}

Result<SuiteOutcome> run_suite(const SuiteOptions& options) {
  std::regex filter;
  try {
    filter = options.filter;
  } catch (const std::regex_error& error) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--filter '{}': {}", options.filter, error.what()),
                "use an ECMAScript regular expression");
  }
  SGS_RETURN_IF_ERROR(io::make_folder(options.output));
  SuiteOutcome outcome;
  outcome.jobs = make_jobs(options, filter);
  outcome.failed = !run_jobs(outcome.jobs, options);
  return outcome;
}

Result<eval::Metrics> job_metrics(const SuiteJob& job) {
  if (!is_done(job)) return fail(ErrorCode::kNotFound, job.folder + " did not end well");
  return eval::load_metrics(fs::path(job.folder) / "metrics.json");
}

std::string ate_cell(const std::vector<eval::Metrics>& runs) {
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

}  // namespace sgs::app
