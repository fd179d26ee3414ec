// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/journal.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace {

/// Half of the second within which a frame is promised to be on the disk.
constexpr std::chrono::milliseconds kJournalInterval{500};

std::string pose_line(const slam::FrameRecord& record) {
  return io::trajectory_text(
      Trajectory(std::vector<StampedPose>{{record.timestamp_s, record.T_online_camera}}));
}

/// Where an interrupted run has ended, trajectory.txt holds its results; makes the poses as they
/// were tracked of it again.
Status journal_of_poses(const std::filesystem::path& folder) {
  SGS_ASSIGN_OR_RETURN(const auto poses, io::read_file(folder / files::kTrajectory));
  if (poses.starts_with(kOnlinePoses)) return {};
  SGS_ASSIGN_OR_RETURN(const auto online, io::read_file(folder / files::kOnline));
  return io::write_file(folder / files::kTrajectory, std::string(kOnlinePoses) + online);
}

}  // namespace

void Journal::Lines::hold(const std::string& line) {
  if (known > 0) {
    --known;
  } else {
    file.hold(line);
  }
}

Journal::Journal(std::shared_ptr<FolderLock> lock, std::vector<NamedWriter> opening)
    : Journal(lock, std::move(opening),
              new_lines(lock->folder() / files::kFrames, slam::frames_csv_header()),
              new_lines(lock->folder() / files::kTrajectory, kOnlinePoses)) {}

Journal::Lines Journal::new_lines(const std::filesystem::path& path, std::string_view head) {
  Lines lines{io::AppendFile(path)};
  lines.file.hold(head);
  return lines;
}

std::unique_ptr<Journal> Journal::resume(std::shared_ptr<FolderLock> lock,
                                         std::vector<NamedWriter> opening) {
  const auto folder = lock->folder();
  auto poses = journal_of_poses(folder);
  if (!poses) log().warn("what was tracked before is written anew: {}", poses.error().text());
  auto frames = lines_of(folder / files::kFrames, slam::frames_csv_header());
  auto tracked = lines_of(folder / files::kTrajectory, kOnlinePoses);
  return std::unique_ptr<Journal>(
      new Journal(std::move(lock), std::move(opening), std::move(frames), std::move(tracked)));
}

// The whole lines of a file that begins with `head`; else it begins anew.
Journal::Lines Journal::lines_of(const std::filesystem::path& path, std::string_view head) {
  const auto text = io::read_file(path);
  if (text && text->starts_with(head)) {
    const std::string_view whole = io::whole_lines(*text);
    const auto lines = static_cast<std::size_t>(std::count(whole.begin(), whole.end(), '\n'));
    return Lines(io::AppendFile(path, whole.size()), lines - 1);
  }
  return new_lines(path, head);
}

Journal::Journal(std::shared_ptr<FolderLock> lock, std::vector<NamedWriter> opening, Lines frames,
                 Lines poses)
    : lock_(std::move(lock)),
      opening_(std::move(opening)),
      frames_(std::move(frames)),
      poses_(std::move(poses)),
      times_made_again_(lock_->times_made_again()) {
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
      const bool has_place = record.lost_reason != alignment::LostReason::kNotInMap;
      if (!record.bad && has_place) poses_.hold(pose_line(record));
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
    SGS_RETURN_IF_ERROR(frames_.file.restore());
    SGS_RETURN_IF_ERROR(poses_.file.restore());
    times_made_again_ = lock_->times_made_again();
  }
  SGS_RETURN_IF_ERROR(frames_.file.sync());
  return poses_.file.sync();
}

}  // namespace sgs::run
