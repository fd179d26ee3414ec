// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/journal.h"

#include <chrono>
#include <system_error>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/run/run_files.h"

namespace sgs::run {
namespace {

/// Half of the second within which a frame is promised to be on the disk.
constexpr std::chrono::milliseconds kJournalInterval{500};

std::string pose_line(const slam::FrameRecord& record) {
  return io::trajectory_text(
      Trajectory(std::vector<StampedPose>{{record.timestamp_s, record.T_odom_camera}}));
}

}  // namespace

Journal::Journal(std::shared_ptr<FolderLock> lock, std::vector<NamedWriter> opening)
    : lock_(std::move(lock)),
      opening_(std::move(opening)),
      frames_(lock_->folder() / files::kFrames),
      poses_(lock_->folder() / files::kTrajectory),
      times_made_again_(lock_->times_made_again()) {
  frames_.hold(slam::frames_csv_header());
  poses_.hold(kOnlinePoses);
  write({});
  try {
    thread_ = std::thread([this] { loop(); });
  } catch (const std::system_error& error) {
    log().warn("no thread for the journal ({}): it is written between frames", error.what());
  }
}

Journal::~Journal() {
  if (!thread_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Journal::add(const slam::FrameRecord& record) {
  if (!thread_.joinable()) return write({record});
  const std::scoped_lock lock(mutex_);
  waiting_.push_back(record);
}

void Journal::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait_for(lock, kJournalInterval, [this] { return stop_; });
    const bool last = stop_;
    const auto records = std::exchange(waiting_, {});
    lock.unlock();
    write(records);
    if (last) return;
    lock.lock();
  }
}

void Journal::write(const std::vector<slam::FrameRecord>& records) {
  Status status;
  try {
    for (const slam::FrameRecord& record : records) {
      frames_.hold(slam::frames_csv_line(record));
      if (!record.bad) poses_.hold(pose_line(record));
    }
    status = try_write();
  } catch (...) {
    status = tl::unexpected(current_error());
  }
  if (!status && !failing_) {
    log().warn("the run goes on, but would not survive a crash now: {}", status.error().text());
  }
  failing_ = !status;
}

Status Journal::try_write() {
  SGS_RETURN_IF_ERROR(lock_->ensure());
  if (times_made_again_ != lock_->times_made_again()) {
    for (const NamedWriter& file : opening_) {
      SGS_RETURN_IF_ERROR(file.write(lock_->folder() / file.name));
    }
    SGS_RETURN_IF_ERROR(frames_.restore());
    SGS_RETURN_IF_ERROR(poses_.restore());
    times_made_again_ = lock_->times_made_again();
  }
  SGS_RETURN_IF_ERROR(frames_.sync());
  return poses_.sync();
}

}  // namespace sgs::run
