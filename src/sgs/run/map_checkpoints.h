// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "sgs/map/gaussian.h"
#include "sgs/run/folder_lock.h"
#include "sgs/slam/frame_record.h"

namespace sgs::run {

/// When the next checkpoint of a map is due. Times are those of any one clock, in seconds.
class CheckpointSchedule {
 public:
  explicit CheckpointSchedule(double interval_s) : interval_s_(interval_s) {}

  /// The first map at once, then one that is larger by half, and every `interval_s`; but never so
  /// often that writing takes more than a fiftieth of one core.
  bool due(double now_s, std::size_t gaussians) const;
  /// A map of that size was written at `now_s`, which took `cpu_s` of a core.
  void written(double now_s, std::size_t gaussians, double cpu_s);

 private:
  double interval_s_;
  double last_s_ = 0, rest_s_ = 0;
  std::size_t gaussians_ = 0;
  bool first_ = true;
};

/// Keeps map.ply and keyframes.txt of a run that is going on, on a thread of low priority that
/// reads published snapshots: neither tracker nor mapper wait for it.
class MapCheckpoints {
 public:
  /// `newest` is called from that thread.
  MapCheckpoints(std::shared_ptr<FolderLock> lock, double interval_s,
                 std::function<map::SnapshotPtr()> newest);
  ~MapCheckpoints();
  MapCheckpoints(const MapCheckpoints&) = delete;
  MapCheckpoints& operator=(const MapCheckpoints&) = delete;

  /// Notes when a keyframe was seen.
  void add(const slam::FrameRecord& record);

 private:
  void loop();
  void look();
  Status write(const map::Snapshot& snapshot);

  std::shared_ptr<FolderLock> lock_;
  std::function<map::SnapshotPtr()> newest_;
  CheckpointSchedule schedule_;
  std::uint64_t written_version_ = 0;
  bool failing_ = false;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::int64_t, double> keyframe_times_s_;  // by frame; guarded by mutex_, and so is:
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace sgs::run
