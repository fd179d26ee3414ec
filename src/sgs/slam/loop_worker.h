// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "sgs/loops/loop_closer.h"
#include "sgs/slam/map_worker.h"

namespace sgs::slam {

/// Runs a LoopCloser beside the tracker. Offline the correction that frame k gave is applied before
/// frame k + lag, however fast anybody is; live before the first frame after it is there.
class LoopWorker {
 public:
  LoopWorker(const SessionConfig& config, MapWorker::Mode mode);
  ~LoopWorker();

  /// The correction to apply before frame number `n` is tracked; the caller must apply it. Waits
  /// for frame n - lag offline, never live. Rethrows a failure of the thread.
  std::shared_ptr<const PoseCorrection> correction_before(std::int64_t n);
  /// Queues the next tracked frame; every frame comes, in order. Live, frames that come faster than
  /// they can be looked at are passed over.
  void submit(std::shared_ptr<const RgbdFrame> frame, const tracker::TrackResult& result);
  /// Finishes what was queued and stops; returns the correction that has not been applied yet, if
  /// there is one.
  std::shared_ptr<const PoseCorrection> finish();

  /// Valid after finish().
  const loops::LoopCloser& closer() const { return closer_; }
  /// Loops in the graph that frame number `n` may know of: those of frame n - lag offline, all that
  /// were found live (thread-safe).
  int loops_before(std::int64_t n) const;

 private:
  struct Job {
    std::shared_ptr<const RgbdFrame> frame;
    tracker::TrackResult result;
    bool corrected = false;  // the correction in flight was applied before this frame
  };
  void process(const Job& job);
  void loop();
  std::shared_ptr<const PoseCorrection> take();

  MapWorker::Mode mode_;
  std::int64_t lag_;
  loops::LoopCloser closer_;
  bool apply_noted_ = true;  // the next job says that the last correction was applied

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  std::deque<Job> queue_;
  std::vector<int> loops_;                       // in the graph after each job
  std::shared_ptr<const PoseCorrection> found_;  // not applied yet
  std::int64_t found_by_ = 0;                    // number of the job
  bool stop_ = false;
  std::exception_ptr failure_;

  std::thread thread_;
};

}  // namespace sgs::slam
