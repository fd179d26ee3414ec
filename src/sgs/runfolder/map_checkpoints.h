// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/map/gaussian.h"
#include "sgs/runfolder/checkpoint_folders.h"
#include "sgs/runfolder/folder_lock.h"
#include "sgs/slam/frame_record.h"

namespace sgs::run {

/// When the next checkpoint of a map is due. Times are those of any one clock, in seconds.
class CheckpointSchedule {
 public:
  explicit CheckpointSchedule(double interval_s) : interval_s_(interval_s) {}

  /// The first map at once, then one that is larger by half, and so early that no map on the disk
  /// gets older than `interval_s`; but never so often that writing takes more than a fiftieth of
  /// one core.
  bool due(double now_s, std::size_t gaussians) const;
  /// The map that was due at `due_s`, and had that size, was written at `now_s`; it took `cpu_s` of
  /// a core.
  void written(double due_s, double now_s, std::size_t gaussians, double cpu_s);
  /// None could be made at `now_s`: the next attempt waits for a moment.
  void failed(double now_s);

 private:
  double interval_s_;
  double due_s_ = 0, written_s_ = 0, rest_s_ = 0;  // of the last one
  std::size_t gaussians_ = 0;
  bool first_ = true;
};

/// What checkpoints are made of.
struct CheckpointSource {
  /// The newest map; called from the thread of the checkpoints.
  std::function<map::SnapshotPtr()> map;
  /// What the run can be gone on from, behind the frames so far (slam::Session::save()); called
  /// from add() and add_last(). Empty: the run cannot.
  std::function<std::future<std::string>()> state;
};

/// Keeps map.ply, keyframes.txt, resume.sgs and, once depth is calibrated, calibration.toml of a
/// run that is going on as checkpoints (CheckpointFolders), on a thread of its own that reads
/// published snapshots: neither tracker nor mapper wait for it. The state is copied by the mapper
/// between two frames.
class MapCheckpoints {
 public:
  MapCheckpoints(std::shared_ptr<FolderLock> lock, double interval_s, CheckpointSource source);
  ~MapCheckpoints();
  MapCheckpoints(const MapCheckpoints&) = delete;
  MapCheckpoints& operator=(const MapCheckpoints&) = delete;

  /// Notes a frame that the session has been fed, and what the run has learned of its depth camera;
  /// add() and add_last() belong to one thread.
  void add(const slam::FrameRecord& record,
           const std::optional<DepthCalibration>& learned = std::nullopt);
  /// The run is asked to stop: makes a checkpoint of all frames so far and returns when it is
  /// there. No more frames may come.
  void add_last();

 private:
  void loop();
  void stop();
  void look();
  Status look_closely();
  std::optional<std::string> take_state();
  std::vector<StampedPose> keyframes_of(const map::Snapshot& snapshot);
  Status write(const map::Snapshot& snapshot, std::optional<std::string> state);
  void report(const Status& status);

  std::shared_ptr<FolderLock> lock_;
  CheckpointSource source_;
  CheckpointFolders folders_;
  CheckpointSchedule schedule_;
  std::uint64_t written_version_ = 0;
  bool failing_ = false;
  std::optional<double> due_s_;  // since when one is wanted

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::int64_t, double> keyframe_times_s_;  // by frame; guarded by mutex_, and so is:
  std::optional<DepthCalibration> learned_;
  std::future<std::string> state_;
  bool state_wanted_ = false;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace sgs::run
