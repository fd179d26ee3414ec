// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/resume.h"

#include <gmock/gmock.h>

#include <stop_token>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/run/execute.h"
#include "sgs/run/test_observer.h"
#include "sgs/runfolder/checkpoint_folders.h"
#include "sgs/runfolder/resume_file.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Runs of a few frames, one whole, others stopped and gone on with.
class ResumeTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new io::TemporaryFolder;
    make("whole", {}, -1, 2);
  }
  static void TearDownTestSuite() { delete scratch_; }

  static InputSpec spec() {
    InputSpec spec;
    spec.input = "synth:room_desk";
    spec.frames = "0:16";
    return spec;
  }
  static fs::path folder(const std::string& name) { return scratch_->path() / name; }

  /// Asks the run to stop after frame `last`; -1 = never.
  static TestObserver stopper(std::stop_source& stop, std::int64_t last) {
    TestObserver observer;
    observer.frame = [&stop, last](const slam::FrameRecord& record) {
      if (record.index == last) stop.request_stop();
    };
    return observer;
  }
  static void make(const std::string& name, const slam::SessionConfig& config, std::int64_t last,
                   int threads, bool realtime = false) {
    auto input = open_input(spec(), 1);
    ASSERT_TRUE(input);
    auto created = RunFolder::create(folder(name));
    ASSERT_TRUE(created);
    RunOptions options;
    options.threads = threads;
    options.realtime = realtime;
    std::stop_source stop;
    TestObserver observer = stopper(stop, last);
    const auto outcome =
        execute(*input, spec(), {config}, options, *created, observer, stop.get_token());
    ASSERT_TRUE(outcome) << outcome.error().text();
    EXPECT_EQ(outcome->stopped, last >= 0);
  }
  static Result<RunResult> resumed_run(const std::string& name, std::int64_t last, int threads,
                                       const std::string& frames = {}) {
    SGS_ASSIGN_OR_RETURN(auto resumed, RunFolder::resume(folder(name)));
    SGS_ASSIGN_OR_RETURN(auto point, load_resume_point(folder(name)));
    InputSpec input_spec = point.saved.input;
    if (!frames.empty()) input_spec.frames = frames;
    SGS_ASSIGN_OR_RETURN(auto input, open_input(input_spec, 1));
    const RunConfig config = point.saved.config;
    RunOptions options;
    options.threads = threads;
    options.resume = std::move(point);
    std::stop_source stop;
    TestObserver observer = stopper(stop, last);
    return execute(input, input_spec, config, options, resumed, observer, stop.get_token());
  }
  static std::string content(const std::string& name, const char* file) {
    const auto text = io::read_file(folder(name) / file);
    EXPECT_TRUE(text) << file;
    return text.value_or("");
  }
  static void expect_same_results(const std::string& name) {
    for (const char* file : {files::kTrajectory, files::kOnline, files::kKeyframes, files::kMap,
                             files::kConfig, files::kTruth}) {
      EXPECT_TRUE(content(name, file) == content("whole", file)) << file;
    }
  }

  static inline io::TemporaryFolder* scratch_ = nullptr;
};

TEST_F(ResumeTest, AStoppedRunComesToTheSameBits) {
  make("stopped", {}, 6, 2);
  const auto state = load_state(folder("stopped"));
  ASSERT_TRUE(state);
  EXPECT_EQ(state->stage, Stage::kInterrupted);
  ASSERT_TRUE(resumed_run("stopped", 11, 1)) << "stopped again, by one thread";
  const auto outcome = resumed_run("stopped", -1, 2);
  ASSERT_TRUE(outcome);
  EXPECT_FALSE(outcome->stopped);
  EXPECT_EQ(outcome->run.frames_total, 16);
  EXPECT_EQ(outcome->run.frames.size(), 16u);
  expect_same_results("stopped");
  EXPECT_TRUE(checkpoints_in(folder("stopped")).empty()) << "they are of no use any more";
  EXPECT_EQ(load_state(folder("stopped"))->stage, Stage::kFinished);
}

TEST_F(ResumeTest, WithoutACheckpointTheRunBeginsAgain) {
  make("early", {}, 6, 2);
  for (const fs::path& part : checkpoints_in(folder("early"))) fs::remove(part);
  ASSERT_TRUE(resumed_run("early", -1, 2));
  expect_same_results("early");
}

// A tracker that follows the map cannot be brought to where it was without the map of that time.
TEST_F(ResumeTest, ATrackerThatFollowsTheMapBeginsAgain) {
  slam::SessionConfig config;
  config.tracker.type = tracker::TrackerType::kGicp;
  config.tracker.target.source = alignment::TargetSource::kOptimised;
  make("follower", config, 6, 2);
  EXPECT_TRUE(load_resume_point(folder("follower"))->checkpoint.empty());
  const auto outcome = resumed_run("follower", -1, 2);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->run.frames.size(), 16u);
}

TEST_F(ResumeTest, OtherFramesThanBeforeAreFoundOutAndNothingChanges) {
  make("changed", {}, 6, 2);
  const auto before = content("changed", files::kTrajectory);
  const auto outcome = resumed_run("changed", -1, 2, "1:16");
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().text(), HasSubstr("is not what it was"));
  const auto shorter = resumed_run("changed", -1, 2, "0:4");
  EXPECT_FALSE(shorter);
  EXPECT_TRUE(content("changed", files::kTrajectory) == before);
  EXPECT_EQ(load_state(folder("changed"))->stage, Stage::kInterrupted);
  ASSERT_TRUE(resumed_run("changed", -1, 2)) << "with the right ones it still can";
  expect_same_results("changed");
}

TEST_F(ResumeTest, AStopOnTheWayBackChangesNothing) {
  make("twice", {}, 6, 2);
  const auto before = content("twice", files::kTrajectory);
  const auto outcome = resumed_run("twice", 3, 2);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kInterrupted);
  EXPECT_TRUE(content("twice", files::kTrajectory) == before);
  ASSERT_TRUE(resumed_run("twice", -1, 2));
  expect_same_results("twice");
}

TEST_F(ResumeTest, WhatCannotBeGoneOnWithIsRefusedByName) {
  const auto refused = [](const fs::path& path) {
    const auto point = load_resume_point(path);
    return point ? std::string("not refused") : point.error().text();
  };
  EXPECT_THAT(refused(folder("whole")), HasSubstr("is finished"));
  EXPECT_THAT(refused(folder("nowhere")), HasSubstr("no run folder"));
  make("live", {}, 5, 2, true);
  EXPECT_THAT(refused(folder("live")), HasSubstr("was live"));
  make("damaged", {}, 6, 2);
  const fs::path file = newest_checkpoint(folder("damaged")) / files::kResume;
  std::string bytes = *io::read_file(file);
  bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
  ASSERT_TRUE(io::write_file(file, bytes));
  const auto damaged = resumed_run("damaged", -1, 2);
  ASSERT_FALSE(damaged);
  EXPECT_THAT(damaged.error().text(), HasSubstr("damaged: the run cannot be gone on with"));
  std::string config = content("damaged", files::kConfig);
  const auto at = config.find("version = \"");
  ASSERT_NE(at, std::string::npos);
  config.insert(at + 11, "9");
  ASSERT_TRUE(io::write_file(folder("damaged") / files::kConfig, config));
  EXPECT_THAT(refused(folder("damaged")), HasSubstr("was made by sgs 9"));
}

}  // namespace
}  // namespace sgs::run
