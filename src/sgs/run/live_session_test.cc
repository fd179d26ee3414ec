// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// What a run does while somebody watches it: it is held, ended, saved and recorded.

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/run/execute.h"
#include "sgs/run/recorded_run.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Passes a source on and counts what it has given; stamps are its own.
class Counted : public dataset::FrameSource {
 public:
  explicit Counted(std::unique_ptr<dataset::FrameSource> source) : source_(std::move(source)) {}
  std::string name() const override { return source_->name(); }
  PinholeCamera camera() const override { return source_->camera(); }
  std::optional<std::int64_t> size() const override { return source_->size(); }
  const Trajectory& ground_truth() const override { return source_->ground_truth(); }
  dataset::FrameRead next(RgbdFrame& frame, Error& error) override {
    const auto read = source_->next(frame, error);
    if (read != dataset::FrameRead::kEnd) ++given;
    return read;
  }
  std::atomic<int> given = 0;

 private:
  std::unique_ptr<dataset::FrameSource> source_;
};

/// Wishes at chosen frames.
class Wishes : public RunObserver {
 public:
  /// Frames fed so far -> what happens before the next one.
  std::function<void(int frames, const std::function<void()>& held)> before;
  bool save = false;
  std::optional<bool> recording;
  LiveStatus status;
  std::vector<std::string> events;
  std::vector<SaveNote> saved;

  double before_frame(const std::function<void()>& held) override {
    held_s_ = 0;
    if (before) before(frames_, held);
    return held_s_;
  }
  void hold_until(const std::function<void()>& held, const std::function<bool()>& enough) {
    do {
      held();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    } while (!enough());
    held_s_ = 1;
  }
  void on_frame(slam::Session&, const dataset::FeedItem&, const slam::FrameRecord&) override {
    ++frames_;
  }
  void on_status(const LiveStatus& now) override { status = now; }
  bool take_save() override { return std::exchange(save, false); }
  std::optional<bool> take_recording() override { return std::exchange(recording, std::nullopt); }
  void on_saved(const SaveNote& note) override { saved.push_back(note); }

 private:
  int frames_ = 0;
  double held_s_ = 0;
};

class LiveSessionTest : public ::testing::Test {
 protected:
  RunResult run(const std::string& name, RunObserver& observer, RunOptions options = {},
                const std::string& frames = "0:8") {
    InputSpec spec;
    spec.input = "synth:room_desk";
    spec.frames = frames;
    auto input = open_input(spec, 1);
    EXPECT_TRUE(input);
    auto counted = std::make_unique<Counted>(std::move(input->source));
    source = counted.get();
    input->source = std::move(counted);
    slam::SessionConfig config;
    config.tracker.type = tracker::TrackerType::kGicp;
    auto folder = RunFolder::create(scratch / name);
    EXPECT_TRUE(folder);
    options.threads = 1;
    auto result = execute(*input, spec, {config}, options, *folder, observer);
    EXPECT_TRUE(result);
    EXPECT_TRUE(folder->failures().empty());
    return std::move(*result);
  }
  std::string bytes(const fs::path& file) {
    const auto read = io::read_file(scratch / file);
    EXPECT_TRUE(read) << file;
    return read.value_or("");
  }

  io::TemporaryFolder scratch;
  Counted* source = nullptr;
};

TEST_F(LiveSessionTest, WhatIsSavedRecordedAndHeldChangesNoBit) {
  Wishes nothing, all;
  run("plain", nothing);
  all.before = [&](int frames, const auto& held) {
    if (frames == 3) all.save = true;
    if (frames == 4) all.hold_until(held, [&, calls = 0]() mutable { return ++calls > 3; });
    if (frames == 2) all.recording = true;
  };
  run("wishes", all);
  EXPECT_EQ(bytes("plain/map.ply"), bytes("wishes/map.ply"));
  EXPECT_EQ(bytes("plain/trajectory.txt"), bytes("wishes/trajectory.txt"));
}

TEST_F(LiveSessionTest, FinishingIsAProperEnd) {
  std::stop_source enough;
  Wishes observer;
  observer.before = [&](int frames, const auto&) {
    if (frames == 5) enough.request_stop();
  };
  RunOptions options;
  options.enough = enough.get_token();
  const RunResult result = run("finished", observer, options);
  EXPECT_FALSE(result.stopped);
  EXPECT_TRUE(result.input);
  EXPECT_EQ(result.too_few, "");
  EXPECT_EQ(result.run.frames.size(), 5u);
  EXPECT_EQ(load_state(scratch / "finished")->stage, Stage::kFinished);
  EXPECT_FALSE(result.run.gaussians.empty());
}

TEST_F(LiveSessionTest, WhatThereIsCanBeSavedOnTheWay) {
  Wishes observer;
  observer.before = [&](int frames, const auto& held) {
    if (frames == 4) observer.save = true;
    // Also while it is held.
    if (frames == 5) {
      observer.hold_until(held, [&] { return observer.saved.size() == 2; });
    }
  };
  observer.save = true;
  run("saved", observer);
  ASSERT_EQ(observer.saved.size(), 2u);
  EXPECT_FALSE(observer.saved[0].done) << "there was no map yet";
  EXPECT_THAT(observer.saved[0].text, HasSubstr("no map yet"));
  EXPECT_TRUE(observer.saved[1].done) << observer.saved[1].text;
  const auto map = io::load_splats(scratch / "saved/saved/map.ply");
  ASSERT_TRUE(map);
  EXPECT_FALSE(map->gaussians.empty());
  const auto path = io::load_trajectory(scratch / "saved/saved/trajectory.txt");
  ASSERT_TRUE(path);
  EXPECT_GE(path->trajectory.size(), 4u);
}

TEST_F(LiveSessionTest, WhatCannotBeSavedIsTold) {
  Wishes observer;
  observer.before = [&](int frames, const auto& held) {
    if (frames != 3) return;
    ASSERT_TRUE(io::write_file(scratch / "blocked/saved", "in the way"));
    observer.save = true;
    observer.hold_until(held, [&] { return !observer.saved.empty(); });
  };
  const RunResult result = run("blocked", observer);
  ASSERT_EQ(observer.saved.size(), 1u);
  EXPECT_FALSE(observer.saved[0].done);
  EXPECT_THAT(observer.saved[0].text, HasSubstr("not saved"));
  EXPECT_EQ(result.run.frames.size(), 8u) << "the run goes on";
}

TEST_F(LiveSessionTest, ARecordingBeginsAndEndsOnTheWay) {
  Wishes observer;
  observer.before = [&](int frames, const auto&) {
    if (frames == 1 || frames == 6) observer.recording = true;
    if (frames == 4) observer.recording = false;
  };
  const RunResult result = run("recorded", observer);
  EXPECT_EQ(result.recording, scratch / "recorded/recording-2");
  const auto first = run_of_recording(result.run, scratch / "recorded/recording");
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_EQ(first->frames_total, static_cast<std::int64_t>(first->frames.size()));
  EXPECT_GE(first->frames.size(), 2u);
  EXPECT_LE(first->frames.size(), 4u);
  EXPECT_EQ(first->frames.front().index, 0) << "as the recording counts";
  EXPECT_GT(first->frames.front().timestamp_s, result.run.frames.front().timestamp_s);
  const auto second = run_of_recording(result.run, result.recording);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->frames.back().timestamp_s, result.run.frames.back().timestamp_s);
  // The folder knows the newest one, also when it has been moved.
  fs::rename(scratch / "recorded", scratch / "moved");
  auto loaded = load_run(scratch / "moved", kAllParts);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->state.recording, "recording-2");
  loaded->input.input = "camera:realsense";  // which cannot be had once more
  const auto found = with_its_recording(std::move(*loaded), scratch / "moved");
  ASSERT_TRUE(found) << found.error().text();
  EXPECT_EQ(found->frames.size(), second->frames.size());
}

TEST_F(LiveSessionTest, FramesOfAPauseAreLeftOutAndNotDropped) {
  Wishes observer;
  int given = 0;
  observer.before = [&](int frames, const auto& held) {
    if (frames != 3) return;
    given = source->given;
    observer.hold_until(held, [&] { return source->given >= given + 10; });
  };
  RunOptions options;
  options.realtime = true;
  options.record = scratch / "kept";
  const RunResult result = run("paused", observer, options, "0:40");
  ASSERT_TRUE(result.run.metrics.frames_dropped);
  const std::int64_t fed = std::ssize(result.run.frames);
  const std::int64_t left_out = 40 - fed - *result.run.metrics.frames_dropped;
  EXPECT_GE(left_out, 9);
  EXPECT_EQ(observer.status.left_out, left_out);
  // What the camera gave is kept, also what was dropped; nothing of the pause but what waited.
  const auto kept = run_of_recording(result.run, scratch / "kept");
  ASSERT_TRUE(kept) << kept.error().text();
  EXPECT_EQ(kept->frames.size(), result.run.frames.size());
  EXPECT_LE(kept->frames_total, 40 - left_out + 7);
}

}  // namespace
}  // namespace sgs::run
