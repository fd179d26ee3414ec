// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/refine.h"

#include <gmock/gmock.h>

#include "sgs/camera/movers.h"
#include "sgs/export/convert.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/run/execute.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A run of a short recording, both made once.
class RefineRunTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new io::TemporaryFolder;
    InputSpec rendered;
    rendered.input = "synth:room_desk";
    rendered.frames = "0:7";
    auto input = open_input(rendered, 1);
    ASSERT_TRUE(input);
    ASSERT_TRUE(convert(*input, recording(), false, {}, {}));
    spec().input = recording().string();
    auto opened = open_input(spec(), 1);
    ASSERT_TRUE(opened);
    slam::SessionConfig config;
    config.keyframe_interval = 3;
    auto folder = RunFolder::create(scratch_->path() / "run");
    ASSERT_TRUE(folder);
    RunOptions options;
    options.threads = 1;
    ASSERT_TRUE(execute(*opened, spec(), {config}, options, *folder));
  }
  static void TearDownTestSuite() { delete scratch_; }

  static fs::path recording() { return scratch_->path() / "recording"; }
  static InputSpec& spec() {
    static InputSpec spec;
    return spec;
  }
  static run::Run loaded() {
    auto run = load_run(scratch_->path() / "run", kAllParts);
    EXPECT_TRUE(run) << run.error().text();
    return std::move(*run);
  }
  static Result<RefinedRun> refine(const run::Run& run, const std::string& name,
                                   std::int64_t steps) {
    auto folder = RunFolder::create(scratch_->path() / name);
    EXPECT_TRUE(folder);
    RefineOptions options;
    options.config.checks = 2;
    options.budget.steps = steps;
    options.threads = 1;
    options.keep_every_s = 0;
    return refine_run(run, options, *folder);
  }

  static inline io::TemporaryFolder* scratch_ = nullptr;
};

TEST_F(RefineRunTest, MakesARunFolderThatIsNoWorse) {
  const run::Run before = loaded();
  const auto refined = refine(before, "refined", 12);
  ASSERT_TRUE(refined) << refined.error().text();
  EXPECT_EQ(refined->frames_used, 6);
  EXPECT_EQ(refined->frames_heldout, 1);
  EXPECT_GE(refined->refined.best.psnr_db, refined->refined.start.psnr_db);
  const auto after = load_run(scratch_->path() / "refined", kAllParts);
  ASSERT_TRUE(after) << after.error().text();
  EXPECT_EQ(after->state.stage, Stage::kFinished);
  EXPECT_EQ(after->trajectory.size(), before.trajectory.size());
  EXPECT_EQ(after->gaussians.size(), refined->refined.best.gaussians);
  EXPECT_EQ(after->input.input, before.input.input);
  for (const slam::FrameRecord& frame : after->frames) {
    EXPECT_NEAR(frame.gain[1], 1, 0.5) << frame.index;  // NaN fails, too
  }
}

// The frames are compared as they were recorded, and learnt from as they should have been.
TEST_F(RefineRunTest, DepthIsCorrectedByWhatTheRunLearned) {
  run::Run run = loaded();
  const auto as_recorded = refine(run, "as_recorded", 4);
  DepthCalibration learned;
  learned.camera = run.camera;
  learned.grid = {2, 2};
  learned.offset_per_m.assign(4, 0.1);
  learned.shift_px = {4, -3};
  run.calibration = learned;
  const auto corrected = refine(run, "corrected", 4);
  ASSERT_TRUE(as_recorded && corrected);
  EXPECT_NE(corrected->refined.last.psnr_db, as_recorded->refined.last.psnr_db);
  EXPECT_TRUE(fs::exists(scratch_->path() / "corrected" / files::kCalibration));
}

// Neither learnt from nor judged by.
TEST_F(RefineRunTest, WhatMovedIsLeftOut) {
  run::Run run = loaded();
  const auto whole = refine(run, "whole", 4);
  PixelMask still(run.camera.width, run.camera.height, std::uint8_t{1});
  for (int v = 0; v < still.height(); ++v) {
    std::fill(still.row(v), still.row(v) + still.width() / 2, std::uint8_t{0});
  }
  for (slam::FrameRecord& frame : run.frames) frame.movers = mover_blocks(still);
  const auto half = refine(run, "half", 4);
  ASSERT_TRUE(whole && half);
  EXPECT_NE(half->refined.start.psnr_db, whole->refined.start.psnr_db);
  EXPECT_NE(half->refined.last.psnr_db, whole->refined.last.psnr_db);
  const auto kept = load_run(scratch_->path() / "half", kFrames);
  ASSERT_TRUE(kept) << kept.error().text();
  EXPECT_EQ(kept->frames.front().movers, run.frames.front().movers);
  EXPECT_TRUE(fs::exists(scratch_->path() / "half" / files::kMovers));
  EXPECT_FALSE(fs::exists(scratch_->path() / "whole" / files::kMovers));
}

TEST_F(RefineRunTest, ACalibrationOfAnotherSizeIsRefused) {
  run::Run run = loaded();
  DepthCalibration other;
  other.camera = run.camera;
  other.camera.width *= 2;
  run.calibration = other;
  const auto refined = refine(run, "other_size", 4);
  ASSERT_FALSE(refined);
  EXPECT_THAT(refined.error().message, HasSubstr(files::kCalibration));
}

TEST_F(RefineRunTest, AChangedPictureIsNamed) {
  run::Run run = loaded();
  run.frames[3].fingerprint ^= 1;
  const auto refined = refine(run, "changed", 5);
  ASSERT_FALSE(refined);
  EXPECT_THAT(refined.error().message, HasSubstr("frame 3 of"));
  EXPECT_FALSE(fs::exists(scratch_->path() / "changed" / files::kMap));
}

TEST_F(RefineRunTest, AnotherTimeIsNamed) {
  run::Run run = loaded();
  run.frames[2].timestamp_s += 0.01;
  const auto refined = refine(run, "late", 5);
  ASSERT_FALSE(refined);
  EXPECT_THAT(refined.error().message, HasSubstr("frame 2 of"));
}

TEST_F(RefineRunTest, ARecordingThatIsShorterIsRefused) {
  run::Run run = loaded();
  slam::FrameRecord more = run.frames.back();
  more.index += 1;
  more.timestamp_s += 0.03;
  run.frames.push_back(more);
  const auto refined = refine(run, "short", 5);
  ASSERT_FALSE(refined);
  EXPECT_THAT(refined.error().message, HasSubstr("frame 7 of"));
}

TEST_F(RefineRunTest, ARecordingThatIsGoneIsSaid) {
  run::Run run = loaded();
  run.input.input = (scratch_->path() / "nowhere").string();
  const auto refined = refine(run, "gone", 5);
  ASSERT_FALSE(refined);
  EXPECT_THAT(refined.error().message, HasSubstr("nowhere"));
  EXPECT_THAT(refined.error().remedy, HasSubstr("bring it back"));
}

TEST_F(RefineRunTest, AStreamIsSaidToBeGone) {
  run::Run run = loaded();
  run.input.input = "live:tcp://127.0.0.1:1";
  const auto refined = refine(run, "stream", 5);
  ASSERT_FALSE(refined);
  EXPECT_THAT(refined.error().remedy, HasSubstr("--record"));
}

TEST_F(RefineRunTest, AMapOfAnotherProgramIsRefinedWithItsPoses) {
  const run::Run ours = loaded();
  const auto theirs = run_of_map(spec(), {ours.gaussians, {}}, ours.trajectory, {}, 1);
  ASSERT_TRUE(theirs) << theirs.error().text();
  EXPECT_EQ(theirs->frames.size(), 7u);
  EXPECT_TRUE(theirs->frames[4].heldout);
  const auto refined = refine(*theirs, "theirs", 8);
  ASSERT_TRUE(refined) << refined.error().text();
  EXPECT_GE(refined->refined.best.psnr_db, refined->refined.start.psnr_db);
}

TEST_F(RefineRunTest, PosesOfAnotherTimeAreRefused) {
  const run::Run ours = loaded();
  const Trajectory elsewhere({{1e9, SE3()}, {1e9 + 1, SE3()}});
  const auto theirs = run_of_map(spec(), {ours.gaussians, {}}, elsewhere, {}, 1);
  ASSERT_FALSE(theirs);
  EXPECT_THAT(theirs.error().message, HasSubstr("none of the 7 frames"));
}

TEST_F(RefineRunTest, ARunWithoutAMapIsRefused) {
  run::Run run = loaded();
  run.gaussians.clear();
  EXPECT_FALSE(refine(run, "empty", 5));
}

}  // namespace
}  // namespace sgs::run
