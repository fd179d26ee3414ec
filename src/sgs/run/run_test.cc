// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/run.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <stop_token>
#include <utility>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/run/execute.h"
#include "sgs/run/play.h"
#include "sgs/run/score.h"
#include "sgs/run/test_observer.h"
#include "sgs/runfolder/journal.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A small run, made once, in a folder of its own.
class RunTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new io::TemporaryFolder;
    spec_.input = "synth:room_desk";
    spec_.frames = "0:6";
    slam::SessionConfig config;
    config.tracker.type = tracker::TrackerType::kGicp;
    outcome_ = new RunResult(make(folder(), config));
  }
  static void TearDownTestSuite() {
    delete outcome_;
    delete scratch_;
  }
  static RunResult make(const fs::path& path, const slam::SessionConfig& config,
                        RunObserver& observer = RunObserver::nobody(),
                        const std::stop_token& stop = {}) {
    auto input = open_input(spec_, 1);
    EXPECT_TRUE(input);
    auto created = RunFolder::create(path);
    EXPECT_TRUE(created);
    RunOptions options;
    options.threads = 1;
    auto outcome = execute(*input, spec_, {config}, options, *created, observer, stop);
    EXPECT_TRUE(outcome);
    EXPECT_TRUE(created->failures().empty());
    return std::move(*outcome);
  }
  static fs::path folder() { return scratch_->path() / "run"; }
  /// A copy of the run's folder that a test may damage.
  static fs::path copy(const std::string& name) {
    const fs::path path = scratch_->path() / name;
    fs::remove_all(path);
    fs::copy(folder(), path, fs::copy_options::recursive);
    return path;
  }

  static inline io::TemporaryFolder* scratch_ = nullptr;
  static inline RunResult* outcome_ = nullptr;
  static inline InputSpec spec_;
};

TEST_F(RunTest, LoadedIsWhatWasMade) {
  const auto loaded = load_run(folder(), kAllParts);
  ASSERT_TRUE(loaded) << loaded.error().text();
  const auto& made = outcome_->run;
  EXPECT_EQ(loaded->camera.fx, made.camera.fx);
  EXPECT_EQ(loaded->camera.width, made.camera.width);
  EXPECT_EQ(loaded->frames.size(), 6u);
  EXPECT_EQ(loaded->trajectory.size(), 6u);
  EXPECT_EQ(loaded->gaussians.size(), made.gaussians.size());
  EXPECT_GT(loaded->gaussians.size(), 100u);
  EXPECT_EQ(loaded->config.tracker.type, tracker::TrackerType::kGicp);
  EXPECT_EQ(loaded->frames_total, 6);
  EXPECT_EQ(slam::frames_csv(loaded->frames), slam::frames_csv(made.frames));
  EXPECT_THAT(loaded->timings_json, HasSubstr("track"));
}

TEST_F(RunTest, ANumberOfFramesThatCannotBeIsNotBelieved) {
  const fs::path damaged = copy("damaged_frames");
  for (const char* frames : {"1000000000000000000", "-5"}) {
    ASSERT_TRUE(
        io::write_file(damaged / files::kMetrics, fmt::format(R"({{"frames": {}}})", frames)));
    const auto loaded = load_run(damaged, kAllParts);
    ASSERT_TRUE(loaded) << loaded.error().text();
    EXPECT_EQ(loaded->frames_total, 6) << frames;
  }
}

// What is scored right after the run is what is scored from its folder later.
TEST_F(RunTest, ScoresOfTheFolderAreThoseOfTheRun) {
  const auto now = score_run(outcome_->run, {});
  ASSERT_TRUE(now);
  ASSERT_TRUE(now->metrics.psnr_db);
  auto loaded = load_run(folder(), kAllParts);
  ASSERT_TRUE(loaded);
  const auto later = score_run(*loaded, {});
  ASSERT_TRUE(later);
  eval::Metrics expected = now->metrics;
  eval::replace_group(expected, "Speed", later->metrics);  // kept by metrics.json, not here yet
  eval::replace_group(expected, "Map", later->metrics);
  eval::replace_group(expected, "Run", later->metrics);
  // A rendered truth has more digits than its file.
  EXPECT_NEAR(*later->metrics.ate_rmse_m, *expected.ate_rmse_m, 1e-9);
  eval::replace_group(expected, eval::kTrajectoryGroup, later->metrics);
  EXPECT_EQ(eval::to_json(later->metrics), eval::to_json(expected));
}

TEST_F(RunTest, ARecordingThatIsGoneCostsNoScoreOfThePath) {
  auto run = outcome_->run;
  run.input.input = "/nowhere/at/all";
  run.metrics.psnr_db = 20;
  const auto kept = score_run(run, {});
  ASSERT_TRUE(kept) << kept.error().text();
  EXPECT_TRUE(kept->metrics.ate_rmse_m);
  EXPECT_FALSE(kept->rendering);
  EXPECT_EQ(kept->metrics.psnr_db, 20);
  EXPECT_EQ(kept->metrics.pictures, eval::kKeptPictures);
  EXPECT_THAT(kept->no_recording, HasSubstr("/nowhere/at/all"));
  run.metrics.psnr_db.reset();
  const auto none = score_run(run, {});
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->metrics.pictures) << "there is nothing that could be kept";
  EXPECT_THAT(none->no_recording, HasSubstr("have no scores"));
}

TEST_F(RunTest, CancelledScoringHasNoScoreOfTheWhole) {
  std::stop_source stop;
  auto run = outcome_->run;
  run.metrics.psnr_db = 99;
  TestObserver observer;
  observer.frames_scored = [&](std::int64_t) { stop.request_stop(); };
  const auto scores = score_run(run, {}, observer, stop.get_token());
  ASSERT_TRUE(scores);
  ASSERT_TRUE(scores->rendering);
  EXPECT_TRUE(scores->rendering->cancelled);
  EXPECT_FALSE(scores->metrics.psnr_db);
  EXPECT_TRUE(scores->metrics.ate_rmse_m);
}

TEST_F(RunTest, AStopRequestEndsTheRunAndKeepsWhatIsThere) {
  std::stop_source stop;
  TestObserver observer;
  observer.frame = [&](const slam::FrameRecord& record) {
    if (record.index == 2) stop.request_stop();
  };
  const auto outcome =
      make(scratch_->path() / "stopped", outcome_->run.config, observer, stop.get_token());
  EXPECT_TRUE(outcome.stopped);
  EXPECT_EQ(outcome.run.frames.size(), 3u);
  EXPECT_TRUE(load_run(scratch_->path() / "stopped", kAllParts));
  const auto stopped = load_state(scratch_->path() / "stopped");
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->stage, Stage::kInterrupted);
  EXPECT_THAT(stopped->sentence("x"), HasSubstr("after 3 frames: stopped by request"));
}

/// The folder of the run as it would be had it been killed after its last frame.
fs::path killed(const fs::path& path, const run::Run& made) {
  fs::remove(path / files::kMetrics);
  fs::remove(path / files::kTimings);
  RunState state;
  state.stage = Stage::kRunning;
  EXPECT_TRUE(io::write_file(path / files::kState, state_text(state)));
  std::vector<StampedPose> online;
  for (const auto& frame : made.frames)
    online.push_back({frame.timestamp_s, frame.T_online_camera});
  EXPECT_TRUE(io::write_file(path / files::kTrajectory,
                             std::string(kOnlinePoses) + io::trajectory_text(Trajectory(online))));
  return path;
}

TEST_F(RunTest, AKilledRunIsReadAsFarAsItCame) {
  TestObserver observer;
  std::vector<slam::FrameRecord> frames;  // those read back have lost their tracked poses
  observer.frame = [&](const slam::FrameRecord& record) { frames.push_back(record); };
  auto config = outcome_->run.config;
  config.keyframe_interval = 2;
  run::Run made = make(scratch_->path() / "whole", config, observer).run;
  ASSERT_EQ(made.state.stage, Stage::kFinished);
  const Trajectory expected = made.trajectory;
  made.frames = frames;
  const fs::path path = killed(scratch_->path() / "whole", made);
  const auto loaded = load_run(path, kAllParts);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_TRUE(loaded->state.unfinished());
  EXPECT_EQ(loaded->state.word(), "killed");
  EXPECT_EQ(loaded->metrics.state, "killed");
  // Tracked poses and refined keyframes make the trajectory that the run would have written.
  ASSERT_GT(loaded->keyframes.size(), 1u);
  ASSERT_EQ(loaded->trajectory.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const SE3 difference =
        loaded->trajectory.poses()[i].T_world_camera.inverse() * expected.poses()[i].T_world_camera;
    EXPECT_LT(difference.t.norm(), 1e-7) << i;
  }
  // Killed before its first checkpoint, before its first frame, before anything.
  fs::remove(path / files::kMap);
  fs::remove(path / files::kKeyframes);
  const auto without_map = load_run(path, kAllParts);
  ASSERT_TRUE(without_map) << without_map.error().text();
  EXPECT_TRUE(without_map->gaussians.empty());
  EXPECT_EQ(without_map->trajectory.size(), 6u);
  EXPECT_TRUE(score_run(*without_map, {}));
  EXPECT_THAT(load_run_map(path).error().remedy, HasSubstr("checkpoint"));
  fs::remove(path / files::kFrames);
  fs::remove(path / files::kTrajectory);
  EXPECT_TRUE(load_run(path, kAllParts));
  fs::remove(path / files::kConfig);
  EXPECT_THAT(load_run(path, kNoParts).error().text(), HasSubstr("has not begun"));
}

// Wherever the last write was cut off, what is before it is there.
TEST_F(RunTest, ATornLineIsLeftOut) {
  const fs::path path = killed(copy("torn"), outcome_->run);
  const auto whole = load_run(path, kFrames | kTrajectory);
  ASSERT_TRUE(whole);
  for (const char* name : {files::kFrames, files::kTrajectory}) {
    const auto text = *io::read_file(path / name);
    const std::size_t first_line = text.find('\n') + 1;
    for (std::size_t size = first_line; size < text.size(); size += 7) {
      ASSERT_TRUE(io::write_file(path / name, text.substr(0, size), io::Durability::kRelaxed));
      const auto torn = load_run(path, kFrames | kTrajectory);
      ASSERT_TRUE(torn) << name << " cut to " << size << ": " << torn.error().text();
      const auto lines = std::count(text.begin(), text.begin() + static_cast<long>(size), '\n') - 1;
      EXPECT_EQ(name == files::kFrames ? torn->frames.size() : torn->trajectory.size(),
                static_cast<std::size_t>(lines));
    }
    ASSERT_TRUE(io::write_file(path / name, text));
  }
  // A finished run has no torn lines: there it is damage.
  fs::remove(path / files::kState);
  const auto text = *io::read_file(path / files::kFrames);
  ASSERT_TRUE(io::write_file(path / files::kFrames, text + "6,7.5,nons"));
  EXPECT_FALSE(load_run(path, kFrames));
}

TEST_F(RunTest, HowItEndedIsSaid) {
  const auto state = load_state(folder());
  ASSERT_TRUE(state) << state.error().text();
  EXPECT_EQ(state->stage, Stage::kFinished);
  EXPECT_EQ(state->frames, 6);
  EXPECT_THAT(state->owner, HasSubstr(fmt::format("process {}", getpid())));
  EXPECT_EQ(state->sentence(folder()), "");
  const fs::path old = copy("stateless");
  fs::remove(old / files::kState);
  EXPECT_EQ(load_state(old)->stage, Stage::kFinished) << "folders from before there was a state";
  ASSERT_TRUE(io::write_file(old / files::kState, "[run]\nstate = \"flying\"\n"));
  EXPECT_FALSE(load_state(old));
}

TEST_F(RunTest, ANewRunBeginsByRemovingTheOldOne) {
  const fs::path path = copy("again");
  ASSERT_TRUE(io::write_file(path / "renders/000001_truth.png", "x"));
  ASSERT_TRUE(io::write_file(path / "renders/mine.png", "x"));
  ASSERT_TRUE(io::write_file(path / "notes.txt", "x"));
  {
    const auto begun = RunFolder::create(path);
    ASSERT_TRUE(begun) << begun.error().text();
    EXPECT_EQ(load_state(path)->word(), "running");
  }
  EXPECT_EQ(load_state(path)->word(), "killed");
  for (const char* name : files::kResults) {
    if (name != files::kLog) {
      EXPECT_FALSE(fs::exists(path / name)) << name;
    }
  }
  EXPECT_FALSE(fs::exists(path / "renders/000001_truth.png"));
  EXPECT_TRUE(fs::exists(path / "renders/mine.png"));
  EXPECT_TRUE(fs::exists(path / "notes.txt"));
}

TEST_F(RunTest, WhatAKilledRunLeftHalfWrittenGoes) {
  const std::vector<std::string> ours = {
      "map.ply.7.tmp", "state.toml.7.tmp", "checkpoint.txt.12345.tmp",
      "renders/000001_truth.png.7.tmp", "renders/pictures.csv.7.tmp"};
  const std::vector<std::string> others = {"notes.txt.7.tmp", "map.ply.mine.tmp",
                                           "renders/mine.png.7.tmp"};
  const auto begin = [](const fs::path& path) { return RunFolder::create(path); };
  for (const auto& [name, open] : {std::pair(std::string("new"), +begin),
                                   std::pair(std::string("resumed"), &RunFolder::resume)}) {
    const fs::path path = copy(name);
    for (const auto* files : {&ours, &others}) {
      for (const std::string& file : *files) ASSERT_TRUE(io::write_file(path / file, "half"));
    }
    ASSERT_TRUE(open(path)) << name;
    for (const std::string& file : ours) EXPECT_FALSE(fs::exists(path / file)) << name << file;
    for (const std::string& file : others) EXPECT_TRUE(fs::exists(path / file)) << name << file;
  }
}

// A recording has a groundtruth.txt and a camera.txt, too.
TEST(RunFolder, AFolderOfSomethingElseIsNotTouched) {
  const io::TemporaryFolder scratch;
  ASSERT_TRUE(io::write_file(scratch / "groundtruth.txt", "x"));
  const auto refused = RunFolder::create(scratch.path());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text(), HasSubstr("groundtruth.txt"));
  EXPECT_EQ(io::read_file(scratch / "groundtruth.txt"), "x");
  EXPECT_FALSE(fs::exists(scratch / files::kLock));
}

TEST_F(RunTest, AFolderRemovedDuringTheRunIsCompleteAgain) {
  const fs::path path = scratch_->path() / "removed";
  TestObserver observer;
  observer.frame = [&](const slam::FrameRecord& record) {
    if (record.index != 3) return;
    // At once, as a disk that is unplugged: a removal file by file may fail because new ones come.
    fs::rename(path, scratch_->path() / "gone");
  };
  const auto outcome = make(path, outcome_->run.config, observer);
  const auto loaded = load_run(path, kAllParts);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->frames.size(), 6u);
  EXPECT_EQ(loaded->state.stage, Stage::kFinished);
  EXPECT_TRUE(fs::exists(path / files::kTruth));
}

TEST_F(RunTest, AFolderTakenByAnotherRunIsLeftToIt) {
  const fs::path path = scratch_->path() / "taken";
  auto folder = RunFolder::create(path);
  ASSERT_TRUE(folder);
  fs::remove_all(path);
  const auto other = RunFolder::create(path);
  ASSERT_TRUE(other) << other.error().text();
  folder->save_text(files::kMap, "mine");
  EXPECT_FALSE(fs::exists(path / files::kMap));
  ASSERT_EQ(folder->failures().size(), 1u);
  EXPECT_THAT(folder->failures()[0].text(), HasSubstr("is being written by"));
  EXPECT_EQ(io::read_file(folder->rescued_to() / files::kMap), "mine");
  fs::remove_all(folder->rescued_to());
}

TEST_F(RunTest, AMissingOrDamagedFileIsNamedWithWhatWorksWithoutIt) {
  const fs::path broken = copy("broken");
  for (const char* name :
       {files::kTrajectory, files::kKeyframes, files::kTruth, files::kFrames, files::kMap}) {
    ASSERT_TRUE(io::write_file(broken / name, "1,2\nnonsense"));
    const auto damaged = load_run(broken, kAllParts);
    ASSERT_FALSE(damaged) << name;
    EXPECT_THAT(damaged.error().text(), HasSubstr(name));
    fs::remove(broken / name);
    const auto missing = load_run(broken, kAllParts);
    ASSERT_FALSE(missing) << name;
    EXPECT_THAT(missing.error().text(), HasSubstr(name));
    EXPECT_THAT(missing.error().remedy, HasSubstr("do"));
    fs::copy_file(folder() / name, broken / name);
  }
  fs::remove(broken / files::kMap);
  EXPECT_TRUE(load_run(broken, kCamera | kTrajectory)) << "parts nobody asked for do not matter";
  EXPECT_FALSE(load_run(scratch_->path() / "nowhere", kNoParts));
}

TEST_F(RunTest, AFolderFromBeforeTheCameraWasKeptAsksTheRecording) {
  const fs::path old = copy("old");
  fs::remove(old / files::kCamera);
  const auto loaded = load_run(old, kCamera);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->camera.fx, outcome_->run.camera.fx);
  auto text = *io::read_file(old / files::kConfig);
  text.replace(text.find("synth:room_desk"), 15, "/no/such/folder");
  ASSERT_TRUE(io::write_file(old / files::kConfig, text));
  const auto gone = load_run(old, kCamera);
  ASSERT_FALSE(gone);
  EXPECT_THAT(gone.error().text(), HasSubstr(files::kCamera));
}

TEST_F(RunTest, AFolderOfALaterVersionIsRefusedByName) {
  const fs::path later = copy("later");
  auto text = *io::read_file(later / files::kConfig);
  const std::string format = fmt::format("format = {}", kFolderFormat);
  ASSERT_NE(text.find(format), std::string::npos);
  text.replace(text.find(format), format.size(), "format = 99");
  ASSERT_TRUE(io::write_file(later / files::kConfig, text));
  const auto loaded = load_run(later, kNoParts);
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("later version"));
}

TEST_F(RunTest, ConfigOfARunMakesTheSameRun) {
  ConfigSources sources;
  sources.file = (folder() / files::kConfig).string();
  InputSpec input;
  const auto config = resolve_config(sources, input);
  ASSERT_TRUE(config) << config.error().text();
  EXPECT_EQ(input.input, "synth:room_desk");
  EXPECT_EQ(config_text(input, *config), outcome_->run.config_toml);
}

/// A short run with a tracker of that type, and what its session used.
struct RunOfType {
  fs::path folder;
  RunConfig used;
};

RunOfType run_with(const fs::path& path, const InputSpec& spec, const RunConfig& config) {
  RunOfType made{path, {}};
  auto input = open_input(spec, 1);
  auto folder = RunFolder::create(path);
  EXPECT_TRUE(input && folder);
  TestObserver observer;
  observer.map = [&](slam::Session& session) { made.used = {session.config(), config.refine}; };
  RunOptions options;
  options.threads = 1;
  EXPECT_TRUE(execute(*input, spec, config, options, *folder, observer));
  return made;
}

// Both of these trackers have a say in what the mapper does.
TEST_F(RunTest, TheConfigurationThatIsKeptIsTheOneThatRan) {
  for (const std::string type : {"render", "given"}) {
    SCOPED_TRACE(type);
    ConfigSources asked;
    asked.tracker = type;
    InputSpec spec;
    spec.input = "synth:room_desk";
    spec.frames = "0:6";
    const auto config = resolve_config(asked, spec);
    ASSERT_TRUE(config);
    const RunOfType first = run_with(scratch_->path() / type, spec, *config);
    const auto content = [](const fs::path& path) { return io::read_file(path).value_or(""); };
    EXPECT_EQ(content(first.folder / files::kConfig), config_text(spec, first.used));
    EXPECT_NE(config_text(spec, first.used), config_text(spec, *config));

    ConfigSources kept;
    kept.file = (first.folder / files::kConfig).string();
    InputSpec spec_again;
    const auto again = resolve_config(kept, spec_again);
    ASSERT_TRUE(again) << again.error().text();
    const RunOfType second = run_with(scratch_->path() / (type + "-again"), spec_again, *again);
    for (const char* name : {files::kConfig, files::kTrajectory, files::kKeyframes, files::kMap}) {
      const std::string was = content(first.folder / name);
      EXPECT_FALSE(was.empty()) << name;
      EXPECT_TRUE(was == content(second.folder / name)) << name;
    }
  }
}

TEST_F(RunTest, ConfigIsRefusedWithTheKeyInQuestion) {
  InputSpec input;
  const auto error_of = [&](const std::string& assignment) {
    ConfigSources sources;
    sources.assignments = {assignment};
    const auto config = resolve_config(sources, input);
    return config ? std::string() : config.error().text();
  };
  EXPECT_EQ(error_of("slam.keyframe_interval=4"), "");
  EXPECT_THAT(error_of("slam.keyframe_interval=0"), HasSubstr("1 .. 1000"));
  EXPECT_THAT(error_of("tracker.fusion=prior"), HasSubstr("tracker.type"));
  EXPECT_THAT(error_of("tracker.type=spectrl"), HasSubstr("spectral"));
  slam::SessionConfig config;
  config.keyframe_interval = 0;
  const auto session = slam::Session::create(config, outcome_->run.camera, {});
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().text(), HasSubstr("slam.keyframe_interval"));
}

TEST(RunFolder, WhatDoesNotFitGoesToTheRescueFolder) {
  const io::TemporaryFolder scratch;
  auto folder = RunFolder::create(scratch.path() / "run");
  ASSERT_TRUE(folder);
  fs::path rescued;
  folder->save("x.txt", [&](const fs::path& path) -> Status {
    if (path.parent_path() == folder->path()) return fail(ErrorCode::kIo, "disk full", "");
    rescued = path;
    return io::write_file(path, "x");
  });
  ASSERT_EQ(folder->failures().size(), 1u);
  EXPECT_EQ(folder->rescued_to(), rescued.parent_path());
  EXPECT_EQ(fs::status(rescued.parent_path()).permissions() & fs::perms::others_all,
            fs::perms::none);
  fs::remove_all(rescued.parent_path());
}

TEST(RunFolder, NothingIsSaidToBeRescuedWhereThatFailedToo) {
  const io::TemporaryFolder scratch;
  auto folder = RunFolder::create(scratch.path() / "run");
  ASSERT_TRUE(folder);
  fs::path rescue;
  folder->save("x.txt", [&](const fs::path& path) -> Status {
    rescue = path.parent_path();
    return fail(ErrorCode::kIo, "disk full", "");
  });
  EXPECT_EQ(folder->failures().size(), 2u);
  EXPECT_TRUE(folder->rescued_to().empty());
  fs::remove_all(rescue);
}

TEST(RunFolder, FreshNamesDoNotCollide) {
  const io::TemporaryFolder scratch;
  const auto a = RunFolder::create_below(scratch.path(), "a b"),
             b = RunFolder::create_below(scratch.path(), "a b");
  ASSERT_TRUE(a && b);
  EXPECT_NE(a->path(), b->path());
  EXPECT_THAT(a->path().filename().string(), HasSubstr("a_b"));
  point_latest_to(scratch.path(), b->path());
  EXPECT_EQ(fs::canonical(scratch.path() / "latest"), fs::canonical(b->path()));
}

TEST_F(RunTest, WhatIsThrownInTheMiddleLosesNothing) {
  TestObserver observer;
  observer.frame = [](const slam::FrameRecord& record) {
    if (record.index == 3) throw std::bad_alloc();
  };
  slam::SessionConfig config;
  config.tracker.type = tracker::TrackerType::kGicp;
  const fs::path path = scratch_->path() / "thrown";
  const RunResult outcome = make(path, config, observer);
  ASSERT_FALSE(outcome.input);
  EXPECT_THAT(outcome.input.error().text(), HasSubstr("out of memory"));
  const auto saved = load_run(path, kTrajectory | kFrames | kMap);
  ASSERT_TRUE(saved) << saved.error().text();
  EXPECT_EQ(saved->frames.size(), 4u);
  EXPECT_FALSE(saved->gaussians.empty());
}

/// One frame, then none that ever comes: the stop is asked for while next() waits.
class StuckSource : public dataset::FrameSource {
 public:
  explicit StuckSource(std::stop_source& stop) : stop_(stop) {}
  std::string name() const override { return "stuck"; }
  PinholeCamera camera() const override { return {64, 48, 60, 60, 31.5, 23.5}; }
  std::optional<std::int64_t> size() const override { return {}; }
  const Trajectory& ground_truth() const override { return truth_; }
  dataset::FrameRead next(RgbdFrame& frame, Error&) override {
    if (std::exchange(first_, false)) {
      frame = {};
      frame.camera = camera();
      frame.color = ColorImage(64, 48);
      frame.depth = DepthImage(64, 48, 1.0f);
      return dataset::FrameRead::kOk;
    }
    stop_.request_stop();
    std::unique_lock lock(mutex_);
    woken_.wait_for(lock, std::chrono::seconds(60), [this] { return stopped_; });
    return dataset::FrameRead::kEnd;
  }
  void stop() override {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    woken_.notify_all();
  }
  bool stopped() const { return stopped_; }

 private:
  std::stop_source& stop_;
  Trajectory truth_;
  std::mutex mutex_;
  std::condition_variable woken_;
  bool first_ = true, stopped_ = false;
};

TEST(Play, AStopReachesASourceThatWaits) {
  for (const bool realtime : {false, true}) {
    std::stop_source stop;
    StuckSource source(stop);
    auto session = slam::Session::create({}, source.camera(), {});
    ASSERT_TRUE(session);
    PlayOptions options;
    options.realtime = realtime;
    const auto clock = play(source, **session, options, RunObserver::nobody(), stop.get_token());
    ASSERT_TRUE(clock) << clock.error().text();
    EXPECT_TRUE(source.stopped());
    // Played live, the stop may come before the frame.
    if (!realtime) {
      EXPECT_EQ((*session)->records().size(), 1u);
    }
  }
}

TEST(RunFolder, HasOneOwnerAtATime) {
  const io::TemporaryFolder scratch;
  auto first = RunFolder::create(scratch.path() / "run");
  ASSERT_TRUE(first);
  const auto second = RunFolder::create(scratch.path() / "run");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text(), HasSubstr(fmt::format("process {}", getpid())));
  first = fail(ErrorCode::kInterrupted, "gone");
  EXPECT_TRUE(RunFolder::create(scratch.path() / "run"));
}

TEST(RunFolder, AWriterThatThrowsIsAFailureLikeAnyOther) {
  const io::TemporaryFolder scratch;
  auto folder = RunFolder::create(scratch.path() / "run");
  ASSERT_TRUE(folder);
  folder->save("x.txt", [](const fs::path&) -> Status { throw std::bad_alloc(); });
  EXPECT_EQ(folder->failures().size(), 2u);
}

}  // namespace
}  // namespace sgs::run
