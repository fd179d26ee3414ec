// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/runner.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <fstream>
#include <set>
#include <thread>

#include "sgs/core/print.h"
#include "sgs/run/exit_code.h"

extern char** environ;

namespace sgs::suite {
namespace {

namespace fs = std::filesystem;

/// The last line of a file that has anything in it.
std::string last_line(const fs::path& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

/// Runs a program and waits for it; what it writes goes to `log`. Returns its exit code, 128 + the
/// signal that ended it, or -1 where it could not be started, which `log` then says.
int run_program(const std::string& program, std::vector<std::string> words, const fs::path& log) {
  words.insert(words.begin(), program);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failed = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    std::ofstream(log) << "cannot start " << program << ": " << std::strerror(failed) << "\n";
    return -1;
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// How one piece of work ended.
struct Ended {
  fs::path made;  ///< what it was to make
  fs::path log;   ///< what was written meanwhile
  int code = 0;
  bool well = false;
};

/// Renders a job's sequence.
Ended render(const std::string& program, const Job& job) {
  Ended ended{job.rendered, job.rendered.string() + ".log"};
  std::error_code error;
  fs::create_directories(job.rendered.parent_path(), error);
  fs::remove_all(job.rendering(), error);
  ended.code = run_program(program, job.render_arguments, ended.log);
  ended.well = ended.code == run::kExitDone;
  if (ended.well) fs::rename(job.rendering(), job.rendered, error);
  if (ended.well) fs::remove(ended.log, error);
  return ended;
}

/// Makes a run. One that lost track has scores, too.
Ended make(const std::string& program, const Job& job) {
  Ended ended{job.folder, job.folder / "console.txt"};
  std::error_code error;
  fs::create_directories(job.folder, error);
  std::ofstream(job.unfinished_mark()).flush();
  ended.code = run_program(program, job.arguments, ended.log);
  ended.well = ended.code == run::kExitDone || ended.code == run::kExitLost;
  if (ended.well) fs::remove(job.unfinished_mark(), error);
  return ended;
}

/// Does `work` for each job, several at a time, until the user interrupts, and says how each ended.
/// Returns whether all did well.
bool for_all(const std::vector<Job>& jobs, const Runner& runner,
             Ended (*work)(const std::string&, const Job&)) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> all_well{true};
  const auto worker = [&] {
    for (std::size_t i = next++; i < jobs.size() && !runner.interrupted(); i = next++) {
      Ended ended;
      try {
        ended = work(runner.program, jobs[i]);
      } catch (...) {
        all_well = false;
        say("[{}/{}] {}\n", i + 1, jobs.size(), current_error().text());
        continue;
      }
      if (!ended.well) all_well = false;
      say("[{}/{}] {} exit {}{}\n", i + 1, jobs.size(), ended.made.string(), ended.code,
          ended.well ? "" : ": " + last_line(ended.log));
    }
  };
  std::vector<std::jthread> pool;  // joined even where the system gives no more of them
  for (int i = 0; i < runner.at_a_time; ++i) pool.emplace_back(worker);
  pool.clear();
  return all_well;
}

template <class Wanted>
std::vector<Job> those(const std::vector<Job>& jobs, const Wanted& wanted) {
  std::vector<Job> out;
  std::copy_if(jobs.begin(), jobs.end(), std::back_inserter(out), wanted);
  return out;
}

}  // namespace

bool Runner::run(const std::vector<Job>& jobs) const {
  const auto missing = those(jobs, [&](const Job& job) { return again || !job.is_done(); });
  if (missing.size() < jobs.size()) {
    say("{} of {} runs were done before (--again repeats them)\n", jobs.size() - missing.size(),
        jobs.size());
  }
  std::set<fs::path> seen;
  const auto unrendered = those(missing, [&](const Job& job) {
    return !job.is_rendered() && seen.insert(job.rendered).second;
  });
  const bool rendered = for_all(unrendered, *this, render);
  const auto ready = those(missing, [](const Job& job) { return job.is_rendered(); });
  return for_all(ready, *this, make) && rendered;
}

}  // namespace sgs::suite
