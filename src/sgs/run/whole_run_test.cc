// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/whole_run.h"

#include <gmock/gmock.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/run/test_observer.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

InputSpec few_frames() {
  InputSpec spec;
  spec.input = "synth:room_desk";
  spec.frames = "0:7";
  return spec;
}

/// The preset `quality` with few steps of everything.
RunConfig quick_quality() {
  auto config = make_run_config("quality");
  EXPECT_TRUE(config);
  config->session.mapper.iterations_per_frame = 1;
  config->refine.least_steps = 10;
  return *config;
}

Result<WholeRun> run_into(const fs::path& path, const RunConfig& config, bool pictures,
                          RunObserver& observer = RunObserver::nobody(),
                          const std::stop_token& stop = {}) {
  SGS_ASSIGN_OR_RETURN(auto input, open_input(few_frames(), 1));
  SGS_ASSIGN_OR_RETURN(auto folder, RunFolder::create(path));
  WholeRunOptions options;
  options.pictures = pictures;
  return run_whole(input, few_frames(), config, options, folder, observer, stop);
}

TEST(WholeRun, RefinesWhereStepsAreAskedForAndScoresWhatCameOfIt) {
  const io::TemporaryFolder scratch;
  TestObserver observer;
  std::int64_t evaluations = 0, scored = 0;
  observer.evaluation = [&](const refine::Evaluation&) { ++evaluations; };
  observer.frames_scored = [&](std::int64_t frames) { scored = frames; };
  const auto whole = run_into(scratch.path() / "run", quick_quality(), true, observer);
  ASSERT_TRUE(whole) << whole.error().text();
  EXPECT_GT(evaluations, 0);
  EXPECT_EQ(scored, 7);
  EXPECT_TRUE(whole->scores.metrics.psnr_db_heldout);
  const auto kept = load_run(scratch.path() / "run", kAllParts);
  ASSERT_TRUE(kept) << kept.error().text();
  EXPECT_EQ(kept->gaussians.size(), whole->result.run.gaussians.size());
  EXPECT_EQ(kept->state.stage, Stage::kFinished);
}

// Its name says where the values come from, and nothing else.
TEST(WholeRun, TheNameOfThePresetSteersNothing) {
  const io::TemporaryFolder scratch;
  RunConfig config = quick_quality();
  config.refine.steps_per_frame = 0;
  TestObserver observer;
  observer.evaluation = [&](const refine::Evaluation&) { FAIL() << "was refined"; };
  ASSERT_TRUE(run_into(scratch.path() / "plain", config, false, observer));
  config.session.preset = slam::Preset::kDefault;
  config.refine.steps_per_frame = 1;
  std::int64_t evaluations = 0;
  observer.evaluation = [&](const refine::Evaluation&) { ++evaluations; };
  ASSERT_TRUE(run_into(scratch.path() / "refined", config, false, observer));
  EXPECT_GT(evaluations, 0);
}

TEST(WholeRun, WhatComesOnlyOnceIsNotRefined) {
  InputSpec spec = few_frames();
  RunOptions options;
  EXPECT_TRUE(check_whole(spec, quick_quality(), options));
  options.realtime = true;
  const Status live = check_whole(spec, quick_quality(), options);
  ASSERT_FALSE(live);
  EXPECT_THAT(live.error().text(), HasSubstr("refine.steps_per_frame"));
  EXPECT_TRUE(check_whole(spec, {}, options));
  spec.input = "live:tcp://127.0.0.1:1";
  EXPECT_FALSE(check_whole(spec, quick_quality(), {}));
  EXPECT_TRUE(check_whole(spec, {}, {}));
  spec.calibration = kCalibrateFirst;
  EXPECT_FALSE(check_whole(spec, {}, {}));
}

TEST(WholeRun, AStopBeforeItIsRefinedLeavesAnUnfinishedRun) {
  const io::TemporaryFolder scratch;
  std::stop_source stop;
  class Stopper : public RunObserver {
   public:
    explicit Stopper(std::stop_source& stop) : stop_(stop) {}
    void on_frames_read(std::int64_t) override { stop_.request_stop(); }

   private:
    std::stop_source& stop_;
  } stopper(stop);
  const auto whole =
      run_into(scratch.path() / "run", quick_quality(), true, stopper, stop.get_token());
  ASSERT_TRUE(whole) << whole.error().text();
  EXPECT_TRUE(whole->result.stopped);
  EXPECT_FALSE(whole->scores.rendering);
  const auto state = load_state(scratch.path() / "run");
  ASSERT_TRUE(state);
  EXPECT_EQ(state->stage, Stage::kInterrupted);
  EXPECT_THAT(state->sentence("x"), HasSubstr("before the map was refined"));
}

// It was the preset's name that had runs refined.
TEST(WholeRun, FoldersOfFormatTwoAreReadAsTheyWereMeant) {
  const io::TemporaryFolder scratch;
  RunConfig old = quick_quality();
  old.refine = {};
  std::string text = config_text(few_frames(), old);
  const auto cut = text.find("[refine]");
  ASSERT_NE(cut, std::string::npos);
  const auto format = text.find("format = 3");
  ASSERT_LT(format, cut);
  text.resize(cut);
  text.replace(format, 10, "format = 2");
  ASSERT_TRUE(io::write_file(scratch.path() / files::kConfig, text));
  const auto saved = load_config(scratch.path());
  ASSERT_TRUE(saved) << saved.error().text();
  EXPECT_GT(saved->config.refine.steps_per_frame, 0);
}

// What an earlier version has run is read; to be run again, it says what takes the key's place.
TEST(WholeRun, FoldersWithParametersThatAreGoneAreRead) {
  const io::TemporaryFolder scratch;
  std::string text = config_text(few_frames(), quick_quality());
  const std::string table = "[loops]\n";
  const auto at = text.find(table);
  ASSERT_NE(at, std::string::npos);
  text.insert(at + table.size(), "memory_mb = 123\n");
  const auto file = scratch.path() / files::kConfig;
  ASSERT_TRUE(io::write_file(file, text));
  const auto saved = load_config(scratch.path());
  EXPECT_TRUE(saved) << saved.error().text();
  ConfigSources sources;
  sources.file = file.string();
  InputSpec input;
  const auto again = resolve_config(sources, input);
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().text().find("history.memory_mb"), std::string::npos)
      << again.error().text();
}

}  // namespace
}  // namespace sgs::run
