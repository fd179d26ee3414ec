// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/back_end_worker.h"

#include <utility>

namespace sgs::slam {
namespace {

constexpr int kBackEndNice = 19;
constexpr std::size_t kMostQueuedLive = 60;  // two seconds

}  // namespace

BackEndWorker::BackEndWorker(std::unique_ptr<BackEnd> back_end, int lag, WorkerMode mode)
    : lag_(lag), back_end_(std::move(back_end)), worker_(mode, tasks(mode)) {}

LaggedWorker<BackEndWorker::Job>::Tasks BackEndWorker::tasks(WorkerMode mode) {
  LaggedWorker<Job>::Tasks tasks;
  tasks.work = [this](const Job& job) {
    newest_ = back_end_->add(job.frame, job.result, job.revision);
  };
  tasks.publish = [this](const Job*) {
    if (newest_) {
      found_ = std::exchange(newest_, std::nullopt);
      found_by_ = static_cast<std::int64_t>(counts_.size());
    }
    counts_.push_back(back_end_->found());
  };
  // Offline frames wait for it: a machine that is busy with other things would hold up all of it.
  if (mode == WorkerMode::kLive) tasks.nice = kBackEndNice;
  return tasks;
}

void BackEndWorker::wait_before(std::int64_t n) {
  if (worker_.mode() == WorkerMode::kLive) return worker_.rethrow_failure();
  (void)worker_.wait([&] { return std::ssize(counts_) > n - lag_; });
}

std::optional<history::Update> BackEndWorker::take_before(std::int64_t n) {
  const auto lock = worker_.lock();
  const bool is_there = worker_.mode() == WorkerMode::kLive || found_by_ <= n - lag_;
  return is_there ? std::exchange(found_, std::nullopt) : std::nullopt;
}

void BackEndWorker::submit(std::shared_ptr<const RgbdFrame> frame,
                           const tracker::TrackResult& result, const history::Revision& revision) {
  if (worker_.mode() == WorkerMode::kLive && worker_.waiting() >= kMostQueuedLive) return;
  worker_.submit({std::move(frame), result, revision});
}

std::optional<history::Update> BackEndWorker::finish(const history::Revision& revision) {
  worker_.finish();
  worker_.rethrow_failure();
  if (found_) return std::exchange(found_, std::nullopt);
  return back_end_->finish(revision);
}

int BackEndWorker::found_before(std::int64_t n) const {
  const auto lock = worker_.lock();
  if (worker_.mode() == WorkerMode::kLive) return counts_.empty() ? 0 : counts_.back();
  return n < lag_ ? 0 : counts_[static_cast<std::size_t>(n - lag_)];
}

}  // namespace sgs::slam
