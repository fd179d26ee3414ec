// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/runner.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "sgs/core/print.h"
#include "sgs/run/exit_code.h"
#include "sgs/suite/claim.h"

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

/// Replaces this process, freshly forked, by the program; only what is safe there. It ends with the
/// worker that started it, so that a killed one leaves nobody who goes on in its name.
[[noreturn]] void become(char* const* argv, const char* log, pid_t parent) {
  constexpr int kCannotStart = 127;
  const int fd = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (fd >= 0) {
    ::dup2(fd, STDOUT_FILENO);
    ::dup2(fd, STDERR_FILENO);
  }
  // Ctrl-C is for the worker, which passes it on once: a second one would not let the run save.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() == parent) ::execv(argv[0], argv);
  ::_exit(kCannotStart);
}

/// Runs a program, what it writes going to `log`, until it ends; one whose claim is lost is told
/// to. Returns its exit code, 128 + the signal that ended it, or -1 where it could not be started.
int run_program(const Runner& runner, std::vector<std::string> words, const fs::path& log,
                const Claim& claim) {
  constexpr auto kPoll = std::chrono::milliseconds(20);
  const std::string& program = runner.program;
  if (::access(program.c_str(), X_OK) != 0) {
    std::ofstream(log) << "cannot start " << program << ": " << std::strerror(errno) << "\n";
    return -1;
  }
  words.insert(words.begin(), program);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) become(argv.data(), log.c_str(), parent);
  if (child < 0) {
    std::ofstream(log) << "cannot start " << program << ": " << std::strerror(errno) << "\n";
    return -1;
  }
  int status = 0;
  bool told = false;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!told && (claim.lost() || runner.interrupted())) {
      ::kill(child, SIGTERM);
      told = true;
    }
    std::this_thread::sleep_for(kPoll);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// How one piece of work ended.
struct JobOutcome {
  fs::path made;  ///< what it was to make
  int code = 0;
  bool well = false;
  std::string last_words = {};
};

/// Moves what was made to its place, and takes away what was there.
std::error_code put_in_place(const fs::path& made, const fs::path& place, const fs::path& old) {
  std::error_code error;
  fs::rename(place, old, error);
  fs::rename(made, place, error);
  std::error_code ignored;
  fs::remove_all(old, ignored);
  return error;
}

/// Renders a job's sequence.
JobOutcome render(const Runner& runner, const Job& job, const Claim& claim) {
  JobOutcome outcome{job.rendered};
  const fs::path part = job.rendering(claim.generation()), log = part.string() + ".log";
  std::error_code error;
  fs::create_directories(part.parent_path(), error);
  fs::remove_all(part, error);
  outcome.code = run_program(runner, job.render_words(part), log, claim);
  outcome.well = outcome.code == run::kExitDone && !claim.lost();
  if (outcome.well) {
    fs::rename(part, job.rendered, error);
    fs::remove(log, error);
  } else {
    outcome.last_words = last_line(log);
  }
  fs::remove_all(part, error);
  return outcome;
}

/// Makes a run. One that lost track has scores, too.
JobOutcome make(const Runner& runner, const Job& job, const Claim& claim) {
  JobOutcome outcome{job.folder};
  const fs::path part = job.making(claim.generation()), log = part / "console.txt";
  std::error_code error;
  fs::remove_all(part, error);
  fs::create_directories(part, error);
  const fs::path unfinished = part / job.unfinished_mark().filename();
  std::ofstream(unfinished).flush();
  outcome.code = run_program(runner, job.words(part), log, claim);
  outcome.last_words = last_line(log);
  if (claim.lost()) {
    fs::remove_all(part, error);
    outcome.last_words = "another worker has taken this run over";
    return outcome;
  }
  outcome.well = outcome.code == run::kExitDone || outcome.code == run::kExitLost;
  if (outcome.well) fs::remove(unfinished, error);
  if (!runner.again && job.is_done()) {  // by a worker that was taken for dead
    fs::remove_all(part, error);
    outcome.well = true;
    return outcome;
  }
  error = put_in_place(part, job.folder, job.making(claim.generation()).string() + ".old");
  if (error) {
    outcome.well = false;
    outcome.last_words = fmt::format("{}: {}", part.string(), error.message());
  }
  for (int older = 0; older < claim.generation(); ++older) fs::remove_all(job.making(older), error);
  return outcome;
}

/// Workers of this process, and what is left for them.
class Crew {
 public:
  Crew(const Runner& runner, const std::vector<Job>& jobs) : runner_(runner), all_(jobs.size()) {
    std::size_t number = 0;
    for (const Job& job : jobs) left_.push_back({&job, ++number, {}, false});
  }

  /// Opens the boards on which work is claimed.
  Status open() {
    const auto lease = std::chrono::duration_cast<ClaimBoard::Duration>(
        std::chrono::duration<double>(runner_.lease_s));
    for (const Item& item : left_) {
      for (const fs::path& place : {item.job->folder, item.job->rendered}) {
        if (place.empty() || boards_.contains(place.parent_path())) continue;
        SGS_ASSIGN_OR_RETURN(boards_[place.parent_path()],
                             ClaimBoard::open(place.parent_path() / "claims", lease));
      }
    }
    return {};
  }

  /// Works until nothing is left or the user interrupts. Returns whether all went well.
  bool work() {
    std::vector<std::jthread> pool;  // joined even where the system gives no more of them
    for (int i = 0; i < runner_.at_a_time; ++i) pool.emplace_back([this] { work_alone(); });
    pool.clear();
    return all_well_;
  }

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Item {
    const Job* job;
    std::size_t number;
    Time not_before;
    bool said;  ///< that it waits for another worker
  };
  enum class Step { kWell, kBad, kAskAgain };

  void work_alone() {
    while (auto item = next()) {
      Step step = Step::kBad;
      try {
        step = attempt(*item);
      } catch (...) {
        say("[{}/{}] {}\n", item->number, all_, current_error().text());
      }
      const std::scoped_lock lock(mutex_);
      if (step == Step::kBad) all_well_ = false;
      if (step == Step::kAskAgain) {
        const double poll_s = std::min(1.0, runner_.lease_s / 4);
        item->not_before =
            std::chrono::steady_clock::now() +
            std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(poll_s));
        left_.push_back(*item);
      }
    }
  }

  /// The next item, as soon as it is time for one; none where nothing is left.
  std::optional<Item> next() {
    constexpr auto kLook = std::chrono::milliseconds(50);
    const auto earlier = [](const Item& a, const Item& b) { return a.not_before < b.not_before; };
    while (!runner_.interrupted()) {
      {
        const std::scoped_lock lock(mutex_);
        const auto first = std::min_element(left_.begin(), left_.end(), earlier);
        if (first == left_.end()) return std::nullopt;
        if (first->not_before <= std::chrono::steady_clock::now()) {
          const Item item = *first;
          left_.erase(first);
          return item;
        }
      }
      std::this_thread::sleep_for(kLook);
    }
    return std::nullopt;
  }

  Step attempt(Item& item) {
    const Job& job = *item.job;
    if (!job.is_rendered()) {
      const Step step = claimed(
          item, job.rendered, [&] { return job.is_rendered(); }, render);
      if (step != Step::kWell) return step;
    }
    return claimed(
        item, job.folder, [&] { return !runner_.again && job.is_done(); }, make);
  }

  /// Does a piece of work once it is claimed, unless it is there by then.
  template <class IsThere>
  Step claimed(Item& item, const fs::path& place, const IsThere& is_there,
               JobOutcome (*make_it)(const Runner&, const Job&, const Claim&)) {
    if (is_there()) return Step::kWell;
    Result<ClaimBoard::Reply> reply =
        boards_.at(place.parent_path())->take(place.filename().string());
    if (!reply) {
      say("[{}/{}] {}\n", item.number, all_, reply.error().text());
      return Step::kBad;
    }
    switch (reply->answer) {
      case ClaimBoard::Answer::kHeld:
        if (!item.said) {
          say("[{}/{}] {} is being made by {}\n", item.number, all_, place.string(), reply->holder);
        }
        item.said = true;
        return Step::kAskAgain;
      case ClaimBoard::Answer::kFailed:
        say("[{}/{}] {} failed at {}\n", item.number, all_, place.string(), reply->holder);
        return Step::kBad;
      case ClaimBoard::Answer::kTaken:
        break;
    }
    Claim& claim = *reply->claim;
    if (is_there()) {  // it was finished between the look and the claim
      report_unwritten(claim.finish(ClaimState::kDone));
      return Step::kWell;
    }
    const JobOutcome outcome = make_it(runner_, *item.job, claim);
    const bool failed = !outcome.well && !runner_.interrupted() && !claim.lost();
    report_unwritten(claim.finish(outcome.well ? ClaimState::kDone
                                  : failed     ? ClaimState::kFailed
                                               : ClaimState::kReleased));
    say("[{}/{}] {} exit {}{}\n", item.number, all_, outcome.made.string(), outcome.code,
        outcome.well ? "" : ": " + outcome.last_words);
    return outcome.well ? Step::kWell : Step::kBad;
  }

  static void report_unwritten(const Status& status) {
    if (!status) say("{}\n", status.error().text());
  }

  const Runner& runner_;
  std::size_t all_;
  std::map<fs::path, std::unique_ptr<ClaimBoard>> boards_;  ///< by the folder whose work it is
  std::mutex mutex_;
  std::deque<Item> left_;
  bool all_well_ = true;
};

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
  Crew crew(*this, missing);
  if (const Status opened = crew.open(); !opened) {
    say("{}\n", opened.error().text());
    return false;
  }
  return crew.work();
}

}  // namespace sgs::suite
