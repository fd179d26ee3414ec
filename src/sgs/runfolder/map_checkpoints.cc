// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/map_checkpoints.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>
#include <vector>

#include "sgs/core/log.h"
#include "sgs/core/low_priority.h"
#include "sgs/core/stopwatch.h"
#include "sgs/io/depth_calibration_io.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/runfolder/resume_file.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {

bool CheckpointSchedule::due(double now_s, std::size_t gaussians) const {
  if (gaussians == 0) return false;
  if (first_) return true;
  if (now_s - written_s_ < rest_s_) return false;
  // The next one will be as long on its way as the last one was.
  const double lead_s = std::min(written_s_ - due_s_, interval_s_ / 2);
  return now_s - due_s_ >= interval_s_ - lead_s || 2 * gaussians >= 3 * gaussians_;
}

void CheckpointSchedule::written(double due_s, double now_s, std::size_t gaussians, double cpu_s) {
  constexpr double kRest = 50;  // times what writing took
  first_ = false;
  due_s_ = due_s;
  written_s_ = now_s;
  gaussians_ = gaussians;
  rest_s_ = kRest * cpu_s;
}

void CheckpointSchedule::failed(double now_s) {
  constexpr double kMoment_s = 1;
  first_ = false;
  due_s_ = written_s_ = now_s;
  rest_s_ = std::max(rest_s_, kMoment_s);
}

MapCheckpoints::MapCheckpoints(std::shared_ptr<FolderLock> lock, double interval_s,
                               CheckpointSource source)
    : lock_(std::move(lock)),
      source_(std::move(source)),
      folders_(lock_->folder()),
      schedule_(interval_s) {
  try {
    thread_ = std::thread([this] { loop(); });
  } catch (const std::system_error& error) {
    log().warn("no thread for checkpoints of the map ({}): none are kept", error.what());
  }
}

MapCheckpoints::~MapCheckpoints() { stop(); }

void MapCheckpoints::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MapCheckpoints::add(const slam::FrameRecord& record,
                         const std::optional<DepthCalibration>& learned) {
  const std::scoped_lock lock(mutex_);
  if (learned != learned_) learned_ = learned;
  if (record.mapping_keyframe) keyframe_times_s_.emplace(record.index, record.timestamp_s);
  if (!std::exchange(state_wanted_, false)) return;
  try {
    state_ = source_.state();
  } catch (...) {  // the run is worth more than its checkpoint
    log().warn("the run goes on, but cannot be gone on with: {}", current_error().text());
  }
}

void MapCheckpoints::add_last() {
  stop();
  try {
    std::optional<std::string> state;
    if (source_.state) state = source_.state().get();  // waits for the mapper
    const auto snapshot = source_.map();
    if (snapshot && !snapshot->gaussians.empty()) report(write(*snapshot, std::move(state)));
  } catch (...) {
    report(tl::unexpected(current_error()));
  }
}

void MapCheckpoints::loop() {
  // Polite, but not starved where other programs keep all cores busy: at nice 19 a checkpoint could
  // take minutes there. What it costs is bounded by CheckpointSchedule.
  constexpr int kNice = 5;
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
  try {
    report(look_closely());
  } catch (...) {
    schedule_.failed(wall_time_s());
    due_s_.reset();
    report(tl::unexpected(current_error()));
  }
}

Status MapCheckpoints::look_closely() {
  const auto snapshot = source_.map();
  if (!snapshot) return {};
  const std::size_t gaussians = snapshot->gaussians.size();
  auto state = take_state();
  if (!state) {
    if (snapshot->version == written_version_) return {};
    if (!due_s_ && !schedule_.due(wall_time_s(), gaussians)) return {};
    if (!due_s_) due_s_ = wall_time_s();
    if (source_.state) {
      const std::scoped_lock lock(mutex_);
      state_wanted_ = state_wanted_ || !state_.valid();
      return {};  // until it has come
    }
  }
  const double began_cpu_s = thread_cpu_time_s();
  const Status status = write(*snapshot, std::move(state));
  schedule_.written(due_s_.value_or(wall_time_s()), wall_time_s(), gaussians,
                    thread_cpu_time_s() - began_cpu_s);
  due_s_.reset();
  if (status) written_version_ = snapshot->version;
  return status;
}

// The state that was asked for, once it is there.
std::optional<std::string> MapCheckpoints::take_state() {
  std::future<std::string> state;
  {
    const std::scoped_lock lock(mutex_);
    const bool there =
        state_.valid() && state_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!there) return std::nullopt;
    state = std::move(state_);
  }
  return state.get();
}

void MapCheckpoints::report(const Status& status) {
  if (!status && !failing_) {
    log().warn("the run goes on, but its map cannot be kept: {}", status.error().text());
  }
  failing_ = !status;
}

std::vector<StampedPose> MapCheckpoints::keyframes_of(const map::Snapshot& snapshot) {
  std::vector<StampedPose> keyframes;
  const std::scoped_lock lock(mutex_);
  const auto count = std::min(snapshot.keyframe_frames.size(), snapshot.T_world_keyframe.size());
  for (std::size_t i = 0; i < count; ++i) {
    // The mapper may be done with a keyframe before its frame was noted here.
    const auto time = keyframe_times_s_.find(snapshot.keyframe_frames[i]);
    if (time == keyframe_times_s_.end()) continue;
    keyframes.push_back({time->second, snapshot.T_world_keyframe[i]});
  }
  return keyframes;
}

Status MapCheckpoints::write(const map::Snapshot& snapshot, std::optional<std::string> state) {
  SGS_RETURN_IF_ERROR(lock_->ensure());
  std::vector<NamedWriter> parts;
  parts.push_back({files::kMap, [&](const std::filesystem::path& path) {
                     return io::save_splats(path, snapshot.gaussians);
                   }});
  parts.push_back({files::kKeyframes, [&](const std::filesystem::path& path) {
                     return io::save_trajectory(path, Trajectory(keyframes_of(snapshot)));
                   }});
  std::optional<DepthCalibration> learned;
  {
    const std::scoped_lock lock(mutex_);
    learned = learned_;
  }
  if (learned) {
    parts.push_back({files::kCalibration, [&](const std::filesystem::path& path) {
                       return io::save_depth_calibration(path, *learned);
                     }});
  }
  if (state) {
    parts.push_back({files::kResume, [&](const std::filesystem::path& path) {
                       return save_resume_file(path, std::move(*state));
                     }});
  }
  return folders_.write(parts);
}

}  // namespace sgs::run
