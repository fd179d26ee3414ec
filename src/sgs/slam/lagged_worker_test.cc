// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/lagged_worker.h"

#include <gmock/gmock.h>

#include <stdexcept>
#include <vector>

namespace sgs::slam {
namespace {

/// Sums the jobs up; -1 fails.
class Summing {
 public:
  explicit Summing(WorkerMode mode) : worker_(mode, tasks()) {}

  void add(int job) { worker_.submit(job); }
  /// The sum behind job number `n`.
  int sum_behind(std::size_t n) {
    const auto lock = worker_.wait([&] { return sums_.size() > n; });
    return sums_[n];
  }
  LaggedWorker<int>& worker() { return worker_; }
  std::size_t done() const {
    const auto lock = worker_.lock();
    return sums_.size();
  }
  int idled() const {
    const auto lock = worker_.lock();
    return idled_;
  }

 private:
  LaggedWorker<int>::Tasks tasks() {
    LaggedWorker<int>::Tasks tasks;
    tasks.work = [this](int& job) {
      if (job < 0) throw std::runtime_error("no such job");
      sum_ += job;
    };
    tasks.publish = [this](const int* job) {
      if (job != nullptr) sums_.push_back(sum_);
      if (job == nullptr) ++idled_;
    };
    tasks.has_idle_work = [this] { return sum_ > 0 && sum_ < 100; };
    tasks.idle_work = [this] { ++sum_; };
    return tasks;
  }

  int sum_ = 0, idled_ = 0;
  std::vector<int> sums_;
  LaggedWorker<int> worker_;
};

TEST(LaggedWorker, ShowsTheSameBehindAJobWithAndWithoutAThread) {
  for (const auto mode : {WorkerMode::kInline, WorkerMode::kThread}) {
    Summing summing(mode);
    for (int job = 1; job <= 50; ++job) summing.add(job);
    EXPECT_EQ(summing.sum_behind(9), 55);
    EXPECT_EQ(summing.sum_behind(49), 1275);
    EXPECT_EQ(summing.idled(), 0) << "only live";
  }
}

TEST(LaggedWorker, FinishesWhatWaits) {
  Summing summing(WorkerMode::kThread);
  for (int job = 1; job <= 50; ++job) summing.add(job);
  summing.worker().finish();
  EXPECT_EQ(summing.done(), 50u);
  EXPECT_FALSE(summing.worker().failed());
}

TEST(LaggedWorker, LiveItWorksOnWhileNoJobComes) {
  Summing summing(WorkerMode::kLive);
  summing.add(1);
  summing.worker().wait([&] { return true; });
  summing.worker().finish();
  EXPECT_EQ(summing.sum_behind(0), 1);
}

TEST(LaggedWorker, AFailureComesToWhoWaitsAndEndsTheWork) {
  Summing summing(WorkerMode::kThread);
  summing.add(1);
  summing.add(-1);
  summing.add(2);
  EXPECT_THROW(summing.sum_behind(2), std::runtime_error);
  EXPECT_THROW(summing.worker().rethrow_failure(), std::runtime_error);
  summing.add(3);
  summing.worker().finish();
  EXPECT_EQ(summing.done(), 1u);
  EXPECT_EQ(summing.worker().waiting(), 0u);
}

TEST(LaggedWorker, InlineAFailureComesOutOfTheJob) {
  Summing summing(WorkerMode::kInline);
  EXPECT_THROW(summing.add(-1), std::runtime_error);
  EXPECT_TRUE(summing.worker().failed());
}

}  // namespace
}  // namespace sgs::slam
