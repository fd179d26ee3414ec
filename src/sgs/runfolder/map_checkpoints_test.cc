// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/map_checkpoints.h"

#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <new>

#include "sgs/io/ply.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/runfolder/checkpoint_folders.h"
#include "sgs/runfolder/resume_file.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

map::SnapshotPtr snapshot_of(std::uint64_t version, std::size_t gaussians) {
  auto snapshot = std::make_shared<map::Snapshot>();
  snapshot->version = version;
  snapshot->gaussians.resize(gaussians);
  for (map::Gaussian& g : snapshot->gaussians) g.rotation[0] = 1;
  snapshot->T_world_keyframe.resize(2);
  snapshot->keyframe_frames = {3, 5};
  return snapshot;
}

TEST(CheckpointSchedule, ByTimeAndBySizeButNeverTooOften) {
  CheckpointSchedule schedule(10);
  EXPECT_FALSE(schedule.due(0, 0)) << "there is no map yet";
  EXPECT_TRUE(schedule.due(0, 100));
  schedule.written(0, 0, 100, 0.01);
  EXPECT_FALSE(schedule.due(1, 120));
  EXPECT_TRUE(schedule.due(1, 150)) << "larger by half";
  EXPECT_TRUE(schedule.due(10, 100));
  EXPECT_FALSE(schedule.due(0.4, 1000)) << "rests fifty times as long as it wrote";
  schedule.written(10, 10, 100, 1);
  EXPECT_FALSE(schedule.due(59, 1000));
  EXPECT_TRUE(schedule.due(61, 100));
  schedule.failed(61);
  EXPECT_FALSE(schedule.due(61.5, 1000)) << "not again at once";
  EXPECT_TRUE(schedule.due(112, 1000));
}

TEST(CheckpointSchedule, BeginsEarlierBySoMuchAsTheLastOneWasOnItsWay) {
  CheckpointSchedule schedule(10);
  schedule.written(0, 3, 100, 0.01);
  EXPECT_FALSE(schedule.due(6, 100));
  EXPECT_TRUE(schedule.due(7, 100)) << "to be there at 10, when the map on the disk is 10 s old";
  schedule.written(7, 27, 100, 0.01);
  EXPECT_TRUE(schedule.due(28, 100)) << "it is late already";
}

/// The newest snapshot, for checkpoints that ask for it; tells when it was asked.
class Published {
 public:
  map::SnapshotPtr operator()() {
    const std::scoped_lock lock(mutex_);
    ++asked_;
    changed_.notify_all();
    if (failing_) throw std::bad_alloc();
    return snapshot_;
  }
  void set(map::SnapshotPtr snapshot, bool failing = false) {
    const std::scoped_lock lock(mutex_);
    snapshot_ = std::move(snapshot);
    failing_ = failing;
  }
  /// Returns when what was set has been seen and dealt with.
  void wait() {
    std::unique_lock lock(mutex_);
    const int enough = asked_ + 2;
    changed_.wait(lock, [&] { return asked_ >= enough; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  map::SnapshotPtr snapshot_;
  int asked_ = 0;
  bool failing_ = false;
};

TEST(MapCheckpoints, KeepWhatIsPublishedAndOutliveFaults) {
  const io::TemporaryFolder scratch;
  const auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  Published published;
  MapCheckpoints checkpoints(*lock, 1000, {[&] { return published(); }, {}});
  const auto on_disk = [&] {
    const auto map = io::load_splats(newest_checkpoint(scratch / "run") / files::kMap);
    return map ? map->gaussians.size() : 0;
  };
  slam::FrameRecord keyframe;
  keyframe.mapping_keyframe = true;
  keyframe.index = 3;
  keyframe.timestamp_s = 0.25;
  checkpoints.add(keyframe);
  published.wait();
  EXPECT_EQ(on_disk(), 0u);
  published.set(snapshot_of(1, 10));
  published.wait();
  EXPECT_EQ(on_disk(), 10u);
  const auto keyframes =
      io::load_trajectory(newest_checkpoint(scratch / "run") / files::kKeyframes);
  ASSERT_TRUE(keyframes);
  ASSERT_EQ(keyframes->trajectory.size(), 1u) << "of frame 5 nothing is known yet";
  EXPECT_EQ(keyframes->trajectory.poses()[0].timestamp_s, 0.25);
  published.set(nullptr, true);
  published.wait();
  std::filesystem::remove_all(scratch / "run");
  published.set(snapshot_of(2, 1000));
  while (on_disk() != 1000) published.wait();  // not before it has rested
}

// The state is asked for between two frames, and written with the map once the mapper has given it.
TEST(MapCheckpoints, KeepWhatTheRunCanGoOnFrom) {
  const io::TemporaryFolder scratch;
  const auto lock = FolderLock::take(scratch / "run");
  ASSERT_TRUE(lock);
  Published published;
  std::vector<std::promise<std::string>> asked;
  std::string last;
  MapCheckpoints checkpoints(*lock, 1000,
                             {[&] { return published(); },
                              [&] {
                                auto& promise = asked.emplace_back();
                                if (!last.empty()) promise.set_value(last);
                                return promise.get_future();
                              }});
  const auto kept = [&] {
    return load_resume_file(newest_checkpoint(scratch / "run") / files::kResume);
  };
  checkpoints.add({});
  EXPECT_TRUE(asked.empty()) << "there is no map yet";
  published.set(snapshot_of(1, 10));
  published.wait();
  checkpoints.add({});
  ASSERT_EQ(asked.size(), 1u);
  checkpoints.add({});
  EXPECT_EQ(asked.size(), 1u) << "one at a time";
  published.wait();
  EXPECT_FALSE(kept());
  asked[0].set_value("first");
  published.wait();
  EXPECT_EQ(kept(), "first");
  last = "last";
  checkpoints.add_last();
  EXPECT_EQ(kept(), "last");
}

}  // namespace
}  // namespace sgs::run
