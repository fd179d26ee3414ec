// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/run_control.h"

#include <chrono>
#include <utility>

#include "sgs/core/stopwatch.h"

namespace sgs::viewer {

void RunControl::pause() {
  const std::scoped_lock lock(mutex_);
  paused_ = true;
  step_ = false;
}

void RunControl::resume() {
  {
    const std::scoped_lock lock(mutex_);
    paused_ = false;
    step_ = false;
  }
  changed_.notify_all();
}

void RunControl::step() {
  {
    const std::scoped_lock lock(mutex_);
    paused_ = true;
    step_ = true;
  }
  changed_.notify_all();
}

bool RunControl::paused() const {
  const std::scoped_lock lock(mutex_);
  return paused_;
}

void RunControl::ask_refinement() { refinement_ = true; }

bool RunControl::refinement_asked() const { return refinement_; }

bool RunControl::take_refinement() { return refinement_.exchange(false); }

void RunControl::finish(AfterRun after) {
  {
    const std::scoped_lock lock(mutex_);
    after_ = after;
  }
  finish_.request_stop();  // without the lock: it calls whoever listens
  changed_.notify_all();
}

AfterRun RunControl::take_after() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(after_, AfterRun::kNothing);
}

AfterRun RunControl::after() const {
  const std::scoped_lock lock(mutex_);
  return after_;
}

void RunControl::set_recording(bool on) {
  const std::scoped_lock lock(mutex_);
  recording_ = on;
}

std::optional<bool> RunControl::take_recording() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(recording_, std::nullopt);
}

double RunControl::wait_turn(const std::function<bool()>& stop) {
  std::unique_lock lock(mutex_);
  if (!paused_) return 0;
  const double since_s = wall_time_s();
  while (paused_ && !step_) {
    lock.unlock();  // stop() may take its time, and locks
    const bool end = stop();
    lock.lock();
    if (end || finish_.stop_requested()) break;
    changed_.wait_for(lock, std::chrono::milliseconds(50), [this] { return !paused_ || step_; });
  }
  step_ = false;
  return wall_time_s() - since_s;
}

}  // namespace sgs::viewer
