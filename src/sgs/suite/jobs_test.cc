// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/jobs.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <set>
#include <thread>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/suite/claim_record.h"
#include "sgs/suite/runner.h"

namespace sgs::suite {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Suite two_scenes_and_a_recording() {
  Suite suite;
  suite.sequences = {
      {"near", "fold", "fr3_near", ""}, {"far", "dual", "", ""}, {"real", "", "", "in"}};
  return suite;
}

Options all_runs() {
  Options options;
  options.output = "out";
  options.levels = {"clean", "hard"};
  options.variants = {{"orb", {"--tracker", "orb"}}};
  options.seeds = {7};
  return options;
}

std::vector<Job> jobs_of(const Options& options) {
  return make_jobs(two_scenes_and_a_recording(), options).value();
}

std::vector<std::string> names(const Options& options) {
  std::vector<std::string> out;
  const std::vector<Job> jobs = jobs_of(options);
  for (const Job& job : jobs) out.push_back(job.name());
  return out;
}

TEST(Jobs, AreNamedByWhatTheyRunAndFilteredByThatName) {
  Options options = all_runs();
  EXPECT_THAT(names(options), ElementsAre("near-clean-orb-7", "far-clean-orb-7", "near-hard-orb-7",
                                          "far-hard-orb-7", "real-recorded-orb-7"));
  options.filter = "^(far|real)-";
  EXPECT_THAT(names(options),
              ElementsAre("far-clean-orb-7", "far-hard-orb-7", "real-recorded-orb-7"));
  options.filter = "(";
  const auto jobs = make_jobs(Suite{}, options);
  ASSERT_FALSE(jobs);
  EXPECT_THAT(jobs.error().text(), HasSubstr("--filter '('"));
}

TEST(Jobs, AreSharedOutWholly) {
  const std::vector<Job> all = jobs_of(all_runs());
  std::set<std::string> seen;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<Job> part = shard(all, i, 3);
    for (const Job& job : part) EXPECT_TRUE(seen.insert(job.name()).second);
  }
  EXPECT_EQ(seen.size(), all.size());
}

TEST(Jobs, SayHowSgsIsToBeStarted) {
  Options options = all_runs();
  EXPECT_THAT(jobs_of(options).front().arguments,
              ElementsAre("run", "synth:fold:clean", "--synth-seed", "7", "--seed", "7", "--quiet",
                          "--tracker", "orb", "--no-eval"));
  options.rendering = true;
  options.frames = 5;
  options.assignments = {"a.b=1"};
  options.trajectories = "tum";
  options.cache = "kept";
  const Job job = jobs_of(options).front();
  EXPECT_THAT(job.arguments, ElementsAre("run", "kept/near-clean-7", "--seed", "7", "--quiet",
                                         "--tracker", "orb", "--frames", "0:5", "--set", "a.b=1"));
  const std::vector<std::string> words = job.words(job.making(2));
  EXPECT_THAT(std::vector(words.end() - 2, words.end()),
              ElementsAre("-o", "out/running/near-clean-orb-7.2"));
  EXPECT_THAT(job.render_words(job.rendering(1)),
              ElementsAre("synth", "fold:clean", "kept/near-clean-7.part1", "--seed", "7",
                          "--quiet", "--trajectory", "tum/fr3_near/groundtruth.txt"));
  options.lpips_weights = "alex.bin";
  const Job recorded = jobs_of(options).back();
  EXPECT_EQ(recorded.arguments[1], "in");
  EXPECT_THAT(recorded.arguments, ::testing::IsSupersetOf({"--lpips-weights", "alex.bin"}));
  EXPECT_TRUE(recorded.render_arguments.empty());
}

/// A stand-in for sgs: `run` leaves scores and a line in `calls`, `synth` makes its folder; the
/// variant's argument is the exit code.
class Runs : public ::testing::Test {
 protected:
  Runs() {
    const auto program = folder_.path() / "sgs";
    EXPECT_TRUE(io::write_file(program, R"(#!/bin/sh
echo "$1" >>)" + calls_.string() + R"(
if [ "$1" = synth ]; then mkdir "$3"; exit; fi
while [ "$1" != --code ]; do shift; done
code=$2
while [ "$1" != -o ]; do shift; done
echo '{"frames": 9}' >"$2/metrics.json"
echo last words
exit "$code"
)"));
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    runner_.program = program.string();
    runner_.interrupted = [this] { return interrupted_; };
    runner_.at_a_time = 2;
    options_.output = (folder_.path() / "out").string();
    options_.levels = {"clean"};
    options_.seeds = {1};
    options_.filter = "near";
  }

  /// Runs one job of the suite, ended by this exit code.
  bool run(int code, bool again = false) {
    options_.variants = {{"v", {"--code", std::to_string(code)}}};
    job_ = jobs_of(options_).front();
    runner_.again = again;
    return runner_.run({job_});
  }
  std::string calls() const { return io::read_file(calls_).value_or(""); }

  io::TemporaryFolder folder_;
  std::filesystem::path calls_ = folder_.path() / "calls";
  Runner runner_;
  Options options_;
  Job job_;
  bool interrupted_ = false;
};

TEST_F(Runs, AreDoneOnceAndAgainWhenAsked) {
  EXPECT_TRUE(run(0));
  EXPECT_TRUE(job_.is_done());
  EXPECT_EQ(job_metrics(job_)->frames, 9);
  EXPECT_THAT(io::read_file(job_.folder / "console.txt").value(), HasSubstr("last words"));
  EXPECT_TRUE(run(0));
  EXPECT_EQ(calls(), "run\n");
  EXPECT_TRUE(run(0, true));
  EXPECT_EQ(calls(), "run\nrun\n");
}

TEST_F(Runs, ThatLoseTrackAreDoneAndThoseThatFailAreNot) {
  EXPECT_TRUE(run(3));
  EXPECT_TRUE(job_.is_done());
  EXPECT_FALSE(run(1, true));
  EXPECT_FALSE(job_.is_done());
  EXPECT_TRUE(std::filesystem::exists(job_.unfinished_mark()));
  EXPECT_FALSE(job_metrics(job_));
  EXPECT_TRUE(run(0));
  EXPECT_TRUE(job_.is_done());
}

TEST_F(Runs, StartNothingAfterAnInterrupt) {
  interrupted_ = true;
  EXPECT_TRUE(run(0));
  EXPECT_EQ(calls(), "");
}

TEST_F(Runs, OfACacheRenderEachSequenceOnce) {
  options_.cache = (folder_.path() / "cache").string();
  EXPECT_TRUE(run(0));
  EXPECT_TRUE(run(0, true));
  EXPECT_EQ(calls(), "synth\nrun\nrun\n");
  EXPECT_TRUE(std::filesystem::is_directory(job_.rendered));
  EXPECT_FALSE(std::filesystem::exists(job_.rendering(0)));
}

TEST_F(Runs, AreMadeOnceByWorkersAtTheSameTime) {
  options_.variants.clear();
  options_.cache = (folder_.path() / "cache").string();
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    options_.variants.push_back({name, {"--code", "0"}});
  }
  const std::vector<Job> jobs = jobs_of(options_);
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < 3; ++i) workers.emplace_back([&] { EXPECT_TRUE(runner_.run(jobs)); });
  }
  const std::string made = calls();
  EXPECT_THAT(made, ::testing::StartsWith("synth\n"));
  EXPECT_EQ(std::count(made.begin(), made.end(), '\n'), 1 + 6);
  for (const Job& job : jobs) EXPECT_TRUE(job.is_done());
  EXPECT_TRUE(std::filesystem::is_empty(jobs[0].making(0).parent_path()));
}

// What a killed worker left is not mistaken for a run, and taken away.
TEST_F(Runs, OfAKilledWorkerAreMadeByAnother) {
  options_.variants = {{"v", {"--code", "0"}}};
  job_ = jobs_of(options_).front();
  ClaimRecord left;
  left.identity = process_identity(::getpid());
  left.identity.back() = left.identity.back() == '1' ? '2' : '1';  // one that is no more
  ASSERT_TRUE(io::write_file(job_.folder.parent_path() / "claims" / (job_.name() + ".0"),
                             claim_text(left)));
  ASSERT_TRUE(io::write_file(job_.making(0) / "frames.csv", "half"));
  EXPECT_TRUE(run(0));
  EXPECT_TRUE(job_.is_done());
  EXPECT_FALSE(std::filesystem::exists(job_.making(0)));
  EXPECT_FALSE(std::filesystem::exists(job_.folder / "frames.csv"));
}

TEST_F(Runs, AProgramThatCannotBeStartedIsAFailure) {
  runner_.program = "/nowhere/sgs";
  EXPECT_FALSE(run(0));
  EXPECT_FALSE(job_.is_done());
}

}  // namespace
}  // namespace sgs::suite
