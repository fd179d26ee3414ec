// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/frame_recorder.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/core/low_priority.h"
#include "sgs/core/stopwatch.h"

namespace sgs::run {
namespace fs = std::filesystem;
namespace {

/// On the disk of `folder`, or of what will hold it. Plenty where nobody knows.
std::uintmax_t free_bytes_at(const fs::path& folder) {
  std::error_code error;
  for (fs::path at = fs::absolute(folder, error); !at.empty(); at = at.parent_path()) {
    const auto space = fs::space(at, error);
    if (!error) return space.available;
    if (at == at.parent_path()) break;
  }
  return std::numeric_limits<std::uintmax_t>::max();
}

Error disk_full(const fs::path& folder) {
  return {ErrorCode::kIo,
          fmt::format("the disk of {} is nearly full: the recording has ended before it is",
                      folder.string()),
          "free some room, or record to another disk"};
}

}  // namespace

FrameRecorder::FrameRecorder(Options options)
    : options_(std::move(options)), disk_(options_.reserve_bytes) {
  if (!options_.free_bytes) options_.free_bytes = free_bytes_at;
  thread_ = std::thread([this] { loop(); });
}

FrameRecorder::~FrameRecorder() {
  {
    const std::scoped_lock lock(mutex_);
    quit_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

Status FrameRecorder::start(const fs::path& folder) {
  const std::scoped_lock lock(mutex_);
  if (status_.on) return {};
  if (options_.free_bytes(folder) <= options_.reserve_bytes) {
    status_.trouble = disk_full(folder).message;
    return tl::unexpected(disk_full(folder));
  }
  auto writer = dataset::TumSequenceWriter::create(folder, options_.camera, options_.writer);
  if (!writer) {
    status_.trouble = writer.error().message;
    return tl::unexpected(writer.error());
  }
  writer_ = std::move(*writer);
  status_ = {};
  status_.on = true;
  status_.folder = folder;
  return {};
}

void FrameRecorder::stop() {
  std::unique_lock lock(mutex_);
  if (!status_.on) return;
  status_.on = false;
  changed_.wait(lock, [this] { return waiting_.empty() && !writing_; });
  writer_.reset();
}

void FrameRecorder::offer(const std::shared_ptr<const RgbdFrame>& frame) {
  std::unique_lock lock(mutex_);
  const auto room = [this] { return !status_.on || waiting_.size() < options_.queue; };
  if (options_.wait) changed_.wait(lock, room);
  if (!status_.on) return;
  if (!room()) {
    if (status_.lost++ == 0) {
      log().warn("recording: frames come faster than they can be written; some are left out");
    }
    return;
  }
  waiting_.push_back(frame);
  changed_.notify_all();
}

RecordingStatus FrameRecorder::status() const {
  const std::scoped_lock lock(mutex_);
  return status_;
}

Status FrameRecorder::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

void FrameRecorder::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return quit_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const auto frame = std::move(waiting_.front());
    waiting_.pop_front();
    writing_ = writer_.has_value();
    lock.unlock();
    if (writing_) write(*frame);
    lock.lock();
    writing_ = false;
    changed_.notify_all();
  }
}

// Of the thread, without the lock.
void FrameRecorder::write(const RgbdFrame& frame) {
  try {
    if (!look_at_disk()) return;
    if (const Status written = writer_->add(frame); !written) return end_with(written.error());
  } catch (...) {
    return end_with(current_error());
  }
  const std::scoped_lock lock(mutex_);
  ++status_.frames;
}

// Returns false when the recording has ended.
bool FrameRecorder::look_at_disk() {
  constexpr double kEvery_s = 0.5;
  const double now_s = wall_time_s();
  if (looked_at_s_ >= 0 && now_s - looked_at_s_ < kEvery_s) return true;
  looked_at_s_ = now_s;
  const fs::path folder = status().folder;
  const auto room = disk_.look(now_s, options_.free_bytes(folder));
  if (room == DiskWatch::Room::kNone) {
    end_with(disk_full(folder));
    return false;
  }
  const std::scoped_lock lock(mutex_);
  status_.seconds_left = disk_.seconds_left();
  const bool low = room == DiskWatch::Room::kLow;
  if (low && status_.trouble.empty()) {
    status_.trouble = fmt::format("the disk of {} has room for {:.0f} more seconds of recording",
                                  folder.string(), disk_.seconds_left().value_or(0));
    log().warn("recording: {}", status_.trouble);
  } else if (!low) {
    status_.trouble.clear();
  }
  return true;
}

// The run is worth more than its recording.
void FrameRecorder::end_with(Error error) {
  log().warn("recording: {}; the run goes on", error.text());
  const std::scoped_lock lock(mutex_);
  status_.on = false;
  status_.trouble = error.message;
  failure_ = tl::unexpected(std::move(error));
  waiting_.clear();
  writer_.reset();
  changed_.notify_all();
}

}  // namespace sgs::run
