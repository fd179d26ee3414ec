// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/past_worker.h"

#include <utility>

#include "sgs/core/low_priority.h"

namespace sgs::slam {
namespace {

constexpr int kPastNice = 19;
constexpr std::size_t kMostQueuedLive = 60;  // two seconds

}  // namespace

PastWorker::PastWorker(std::unique_ptr<PastEstimator> estimator, int lag, MapWorker::Mode mode)
    : mode_(mode), lag_(lag), estimator_(std::move(estimator)) {
  if (mode_ != MapWorker::Mode::kInline) thread_ = std::thread([this] { loop(); });
}

PastWorker::~PastWorker() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    queue_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void PastWorker::process(const Job& job) {
  for (const auto& correction : job.applied) estimator_->note_applied(*correction);
  auto correction = estimator_->add(job.frame, job.result);
  const std::scoped_lock lock(mutex_);
  if (correction) {
    found_ = std::move(correction);
    found_by_ = static_cast<std::int64_t>(counts_.size());
  }
  counts_.push_back(estimator_->found());
}

void PastWorker::loop() {
  // Offline frames wait for it: a machine that is busy with other things would hold up all of it.
  if (mode_ == MapWorker::Mode::kLive) lower_thread_priority(kPastNice);
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

std::shared_ptr<const PastCorrection> PastWorker::correction_before(std::int64_t n) {
  std::unique_lock lock(mutex_);
  if (mode_ == MapWorker::Mode::kLive) {
    if (failure_) std::rethrow_exception(failure_);
    return std::exchange(found_, nullptr);
  }
  const std::int64_t wanted = n - lag_;
  if (wanted < 0) return nullptr;
  changed_.wait(lock, [&] { return failure_ || std::ssize(counts_) > wanted; });
  if (failure_) std::rethrow_exception(failure_);
  return found_ && found_by_ <= wanted ? std::exchange(found_, nullptr) : nullptr;
}

void PastWorker::submit(std::shared_ptr<const RgbdFrame> frame, const tracker::TrackResult& result,
                        const PastCorrections& applied) {
  applied_.insert(applied_.end(), applied.begin(), applied.end());
  {
    const std::scoped_lock lock(mutex_);
    if (mode_ == MapWorker::Mode::kLive && queue_.size() >= kMostQueuedLive) return;
  }
  Job job{std::move(frame), result, std::exchange(applied_, {})};
  if (mode_ == MapWorker::Mode::kInline) {
    process(job);
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    queue_.push_back(std::move(job));
  }
  changed_.notify_all();
}

std::shared_ptr<const PastCorrection> PastWorker::finish(const PastCorrections& applied) {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
  if (found_) return std::exchange(found_, nullptr);
  applied_.insert(applied_.end(), applied.begin(), applied.end());
  for (const auto& correction : std::exchange(applied_, {})) estimator_->note_applied(*correction);
  return estimator_->finish();
}

int PastWorker::found_before(std::int64_t n) const {
  const std::scoped_lock lock(mutex_);
  if (mode_ == MapWorker::Mode::kLive) return counts_.empty() ? 0 : counts_.back();
  return n < lag_ ? 0 : counts_[static_cast<std::size_t>(n - lag_)];
}

}  // namespace sgs::slam
