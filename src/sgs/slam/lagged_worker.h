// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "sgs/core/low_priority.h"
#include "sgs/core/stopwatch.h"

namespace sgs::slam {

/// How work beside the tracker goes.
enum class WorkerMode {
  kInline,  ///< jobs run inside submit(): one thread, same results as kThread
  kThread,  ///< a thread of its own; who waits for job n - lag sees the same whoever is faster
  kLive,    ///< a thread of its own; nobody waits, what is there counts
};

/// Does jobs in the order in which they come, beside the thread that submits them. What comes of a
/// job is its owner's: made without the lock (Tasks::work), shown to others under it
/// (Tasks::publish). A task that throws ends the work: jobs that wait are dropped, and the failure
/// comes to who waits or asks. The owner declares it as its last member, so that the thread is gone
/// before what the tasks use.
template <class Job>
class LaggedWorker {
 public:
  using Lock = std::unique_lock<std::mutex>;

  struct Tasks {
    /// Of the worker's thread; inline of the submitting one.
    std::function<void(Job&)> work;
    /// Called under the lock after each job, and after idle work (null).
    std::function<void(const Job*)> publish;
    /// Live: whether there is something to do while no job waits, and that. May both be empty.
    std::function<bool()> has_idle_work = {};
    std::function<void()> idle_work = {};
    int nice = 0;  ///< priority of the thread as of nice(1); 0 = as the rest
  };

  LaggedWorker(WorkerMode mode, Tasks tasks) : mode_(mode), tasks_(std::move(tasks)) {
    if (mode_ != WorkerMode::kInline) thread_ = std::thread([this] { loop(); });
  }
  ~LaggedWorker() {
    {
      const std::scoped_lock lock(mutex_);
      stop_ = true;
      queue_.clear();
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  LaggedWorker(const LaggedWorker&) = delete;
  LaggedWorker& operator=(const LaggedWorker&) = delete;

  WorkerMode mode() const { return mode_; }
  /// Queues a job; dropped where the work has failed. Inline the job is done then, and what it
  /// throws comes out.
  void submit(Job job) {
    if (mode_ == WorkerMode::kInline) return work_inline(job);
    {
      const std::scoped_lock lock(mutex_);
      if (!failure_) queue_.push_back(std::move(job));
    }
    changed_.notify_all();
  }
  /// Jobs that wait.
  std::size_t waiting() const {
    const auto held = lock();
    return queue_.size();
  }
  /// What publish() writes is read and written under it.
  Lock lock() const { return Lock(mutex_); }
  /// Waits until `ready()`, called under the lock, is true; rethrows a failure.
  template <class Ready>
  Lock wait(Ready&& ready) {
    Lock held(mutex_);
    changed_.wait(held, [&] { return failure_ || ready(); });
    if (failure_) std::rethrow_exception(failure_);
    return held;
  }
  /// Does what waits, and stops.
  void finish() {
    {
      const std::scoped_lock lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  bool failed() const {
    const auto held = lock();
    return failure_ != nullptr;
  }
  void rethrow_failure() const {
    const std::scoped_lock lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
  }
  /// Seconds that the thread has been at work so far.
  double busy_s() const {
    const std::scoped_lock lock(mutex_);
    return busy_s_ + (busy_since_s_ >= 0 ? wall_time_s() - busy_since_s_ : 0.0);
  }

 private:
  void work_inline(Job& job) {
    try {
      tasks_.work(job);
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      failure_ = std::current_exception();
      throw;
    }
    const std::scoped_lock lock(mutex_);
    tasks_.publish(&job);
  }

  bool has_idle_work() const {
    return mode_ == WorkerMode::kLive && tasks_.has_idle_work && tasks_.has_idle_work();
  }

  void loop() {
    if (tasks_.nice > 0) lower_thread_priority(tasks_.nice);
    Lock held(mutex_);
    while (true) {
      if (!has_idle_work()) changed_.wait(held, [&] { return stop_ || !queue_.empty(); });
      if (queue_.empty() && stop_) return;
      std::optional<Job> job;
      if (!queue_.empty()) {
        job.emplace(std::move(queue_.front()));
        queue_.pop_front();
      }
      busy_since_s_ = wall_time_s();
      held.unlock();
      try {
        job ? tasks_.work(*job) : tasks_.idle_work();
        held.lock();
        tasks_.publish(job ? &*job : nullptr);
      } catch (...) {
        if (!held.owns_lock()) held.lock();
        failure_ = std::current_exception();
        queue_.clear();
        changed_.notify_all();
        return;
      }
      busy_s_ += wall_time_s() - busy_since_s_;
      busy_since_s_ = -1;
      changed_.notify_all();
    }
  }

  const WorkerMode mode_;
  const Tasks tasks_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  std::deque<Job> queue_;
  bool stop_ = false;
  std::exception_ptr failure_;
  double busy_s_ = 0;
  double busy_since_s_ = -1;  // < 0: idle

  std::thread thread_;
};

}  // namespace sgs::slam
