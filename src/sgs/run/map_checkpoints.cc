// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/map_checkpoints.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>
#include <vector>

#include "sgs/core/log.h"
#include "sgs/core/low_priority.h"
#include "sgs/core/stopwatch.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/run/run_files.h"

namespace sgs::run {

bool CheckpointSchedule::due(double now_s, std::size_t gaussians) const {
  if (gaussians == 0) return false;
  if (first_) return true;
  const double since_s = now_s - last_s_;
  if (since_s < rest_s_) return false;
  return since_s >= interval_s_ || 2 * gaussians >= 3 * gaussians_;
}

void CheckpointSchedule::written(double now_s, std::size_t gaussians, double cpu_s) {
  constexpr double kRest = 50;  // times what writing took
  first_ = false;
  last_s_ = now_s;
  gaussians_ = gaussians;
  rest_s_ = kRest * cpu_s;
}

MapCheckpoints::MapCheckpoints(std::shared_ptr<FolderLock> lock, double interval_s,
                               std::function<map::SnapshotPtr()> newest)
    : lock_(std::move(lock)), newest_(std::move(newest)), schedule_(interval_s) {
  try {
    thread_ = std::thread([this] { loop(); });
  } catch (const std::system_error& error) {
    log().warn("no thread for checkpoints of the map ({}): none are kept", error.what());
  }
}

MapCheckpoints::~MapCheckpoints() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MapCheckpoints::add(const slam::FrameRecord& record) {
  if (!record.mapping_keyframe) return;
  const std::scoped_lock lock(mutex_);
  keyframe_times_s_.emplace(record.index, record.timestamp_s);
}

void MapCheckpoints::loop() {
  constexpr int kNice = 19;
  constexpr std::chrono::milliseconds kLookEvery{250};
  lower_thread_priority(kNice);
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kLookEvery, [this] { return stop_; })) {
    lock.unlock();
    look();
    lock.lock();
  }
}

void MapCheckpoints::look() {
  Status status;
  try {
    const auto snapshot = newest_();
    if (!snapshot || snapshot->version == written_version_) return;
    const std::size_t gaussians = snapshot->gaussians.size();
    if (!schedule_.due(wall_time_s(), gaussians)) return;
    const double began_cpu_s = thread_cpu_time_s();
    status = write(*snapshot);
    schedule_.written(wall_time_s(), gaussians, thread_cpu_time_s() - began_cpu_s);
    if (status) written_version_ = snapshot->version;
  } catch (...) {
    status = tl::unexpected(current_error());
  }
  if (!status && !failing_) {
    log().warn("the run goes on, but its map cannot be kept: {}", status.error().text());
  }
  failing_ = !status;
}

Status MapCheckpoints::write(const map::Snapshot& snapshot) {
  SGS_RETURN_IF_ERROR(lock_->ensure());
  std::vector<StampedPose> keyframes;
  {
    const std::scoped_lock lock(mutex_);
    const auto count = std::min(snapshot.keyframe_frames.size(), snapshot.T_world_keyframe.size());
    for (std::size_t i = 0; i < count; ++i) {
      // The mapper may be done with a keyframe before its frame was noted here.
      const auto time = keyframe_times_s_.find(snapshot.keyframe_frames[i]);
      if (time == keyframe_times_s_.end()) continue;
      keyframes.push_back({time->second, snapshot.T_world_keyframe[i]});
    }
  }
  SGS_RETURN_IF_ERROR(io::save_splats(lock_->folder() / files::kMap, snapshot.gaussians));
  return io::save_trajectory(lock_->folder() / files::kKeyframes, Trajectory(std::move(keyframes)));
}

}  // namespace sgs::run
