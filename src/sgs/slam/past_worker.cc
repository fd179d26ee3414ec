// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/past_worker.h"

#include <utility>

namespace sgs::slam {
namespace {

constexpr int kPastNice = 19;
constexpr std::size_t kMostQueuedLive = 60;  // two seconds

}  // namespace

PastWorker::PastWorker(std::unique_ptr<PastEstimator> estimator, int lag, WorkerMode mode)
    : lag_(lag), estimator_(std::move(estimator)), worker_(mode, tasks(mode)) {}

LaggedWorker<PastWorker::Job>::Tasks PastWorker::tasks(WorkerMode mode) {
  LaggedWorker<Job>::Tasks tasks;
  tasks.work = [this](const Job& job) {
    for (const auto& correction : job.applied) estimator_->note_applied(*correction);
    newest_ = estimator_->add(job.frame, job.result);
  };
  tasks.publish = [this](const Job*) {
    if (newest_) {
      found_ = std::move(newest_);
      found_by_ = static_cast<std::int64_t>(counts_.size());
    }
    counts_.push_back(estimator_->found());
  };
  // Offline frames wait for it: a machine that is busy with other things would hold up all of it.
  if (mode == WorkerMode::kLive) tasks.nice = kPastNice;
  return tasks;
}

std::shared_ptr<const PastCorrection> PastWorker::correction_before(std::int64_t n) {
  if (worker_.mode() == WorkerMode::kLive) {
    worker_.rethrow_failure();
    const auto lock = worker_.lock();
    return std::exchange(found_, nullptr);
  }
  const std::int64_t wanted = n - lag_;
  if (wanted < 0) return nullptr;
  const auto lock = worker_.wait([&] { return std::ssize(counts_) > wanted; });
  return found_ && found_by_ <= wanted ? std::exchange(found_, nullptr) : nullptr;
}

void PastWorker::submit(std::shared_ptr<const RgbdFrame> frame, const tracker::TrackResult& result,
                        const PastCorrections& applied) {
  applied_.insert(applied_.end(), applied.begin(), applied.end());
  if (worker_.mode() == WorkerMode::kLive && worker_.waiting() >= kMostQueuedLive) return;
  worker_.submit({std::move(frame), result, std::exchange(applied_, {})});
}

std::shared_ptr<const PastCorrection> PastWorker::finish(const PastCorrections& applied) {
  worker_.finish();
  worker_.rethrow_failure();
  if (found_) return std::exchange(found_, nullptr);
  applied_.insert(applied_.end(), applied.begin(), applied.end());
  for (const auto& correction : std::exchange(applied_, {})) estimator_->note_applied(*correction);
  return estimator_->finish();
}

int PastWorker::found_before(std::int64_t n) const {
  const auto lock = worker_.lock();
  if (worker_.mode() == WorkerMode::kLive) return counts_.empty() ? 0 : counts_.back();
  return n < lag_ ? 0 : counts_[static_cast<std::size_t>(n - lag_)];
}

}  // namespace sgs::slam
