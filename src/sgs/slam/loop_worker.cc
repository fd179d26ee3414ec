// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/loop_worker.h"

#include <utility>

#include "sgs/core/low_priority.h"

namespace sgs::slam {
namespace {

constexpr int kLoopNice = 19;
constexpr std::size_t kMostQueuedLive = 60;  // two seconds

}  // namespace

LoopWorker::LoopWorker(const SessionConfig& config, MapWorker::Mode mode)
    : mode_(mode), lag_(config.loops.lag), closer_(config.loops, config.tracker, config.seed) {
  if (mode_ != MapWorker::Mode::kInline) thread_ = std::thread([this] { loop(); });
}

LoopWorker::~LoopWorker() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    queue_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void LoopWorker::process(const Job& job) {
  if (job.corrected) closer_.note_applied();
  auto correction = closer_.add(*job.frame, job.result);
  const std::scoped_lock lock(mutex_);
  if (correction) {
    found_ = std::make_shared<const PoseCorrection>(std::move(*correction));
    found_by_ = static_cast<std::int64_t>(loops_.size());
  }
  loops_.push_back(static_cast<int>(closer_.skeleton().loops().size()));
}

void LoopWorker::loop() {
  lower_thread_priority(kLoopNice);
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return stop_ || !queue_.empty(); });
    if (queue_.empty()) return;
    const Job job = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    try {
      process(job);
    } catch (...) {
      lock.lock();
      failure_ = std::current_exception();
      changed_.notify_all();
      return;
    }
    lock.lock();
    changed_.notify_all();
  }
}

// Hands out what was found; the next job tells the closer so. Needs the lock.
std::shared_ptr<const PoseCorrection> LoopWorker::take() {
  if (found_) apply_noted_ = false;
  return std::exchange(found_, nullptr);
}

std::shared_ptr<const PoseCorrection> LoopWorker::correction_before(std::int64_t n) {
  std::unique_lock lock(mutex_);
  if (mode_ == MapWorker::Mode::kLive) {
    if (failure_) std::rethrow_exception(failure_);
    return take();
  }
  const std::int64_t wanted = n - lag_;
  if (wanted < 0) return nullptr;
  changed_.wait(lock, [&] { return failure_ || std::ssize(loops_) > wanted; });
  if (failure_) std::rethrow_exception(failure_);
  return found_ && found_by_ <= wanted ? take() : nullptr;
}

void LoopWorker::submit(std::shared_ptr<const RgbdFrame> frame,
                        const tracker::TrackResult& result) {
  Job job{std::move(frame), result, !apply_noted_};
  if (mode_ == MapWorker::Mode::kInline) {
    apply_noted_ = true;
    process(job);
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    if (mode_ == MapWorker::Mode::kLive && queue_.size() >= kMostQueuedLive) return;
    apply_noted_ = true;
    queue_.push_back(std::move(job));
  }
  changed_.notify_all();
}

std::shared_ptr<const PoseCorrection> LoopWorker::finish() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
  const std::scoped_lock lock(mutex_);
  return std::exchange(found_, nullptr);
}

int LoopWorker::loops_before(std::int64_t n) const {
  const std::scoped_lock lock(mutex_);
  if (mode_ == MapWorker::Mode::kLive) return loops_.empty() ? 0 : loops_.back();
  return n < lag_ ? 0 : loops_[static_cast<std::size_t>(n - lag_)];
}

}  // namespace sgs::slam
