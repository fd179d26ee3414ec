// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sgs/slam/lagged_worker.h"
#include "sgs/slam/past_estimator.h"

namespace sgs::slam {

/// Corrections that were applied before a frame, in order.
using PastCorrections = std::vector<std::shared_ptr<const PastCorrection>>;

/// Runs a PastEstimator beside the tracker. Offline the correction that frame k gave is applied
/// before frame k + lag, however fast anybody is; live before the first frame after it is there.
class PastWorker {
 public:
  PastWorker(std::unique_ptr<PastEstimator> estimator, int lag, WorkerMode mode);

  /// The correction to apply before frame number `n` is tracked, or null; the caller must apply it.
  /// Waits for frame n - lag offline, never live. Rethrows a failure of the thread.
  std::shared_ptr<const PastCorrection> correction_before(std::int64_t n);
  /// Queues the next tracked frame; every frame comes, in order, with all corrections, whoever
  /// found them, that were applied since the one before. Live, frames that come faster than they
  /// can be looked at are passed over.
  void submit(std::shared_ptr<const RgbdFrame> frame, const tracker::TrackResult& result,
              const PastCorrections& applied);
  /// Finishes what was queued and stops; returns the correction that has not been applied yet, if
  /// there is one, or what is found at the end. `applied`: since the last frame.
  std::shared_ptr<const PastCorrection> finish(const PastCorrections& applied = {});

  /// PastEstimator::found() as frame number `n` may know it: of frame n - lag offline, the newest
  /// live (thread-safe).
  int found_before(std::int64_t n) const;

 private:
  struct Job {
    std::shared_ptr<const RgbdFrame> frame;
    tracker::TrackResult result;
    PastCorrections applied;  // before this frame
  };
  LaggedWorker<Job>::Tasks tasks(WorkerMode mode);

  std::int64_t lag_;
  std::unique_ptr<PastEstimator> estimator_;
  std::shared_ptr<const PastCorrection> newest_;  // of the job at work
  PastCorrections applied_;                       // since the last job
  // Guarded by the worker's lock:
  std::vector<int> counts_;                      // found() after each job
  std::shared_ptr<const PastCorrection> found_;  // not applied yet
  std::int64_t found_by_ = 0;                    // number of the job

  LaggedWorker<Job> worker_;  // last: its thread uses all of the above
};

}  // namespace sgs::slam
