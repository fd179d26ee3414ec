// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/slam/back_end.h"
#include "sgs/slam/lagged_worker.h"

namespace sgs::slam {

/// Runs a BackEnd beside the tracker. Offline the update that frame k gave is there from frame
/// k + lag on, however fast anybody is; live from the first frame after it was found.
class BackEndWorker {
 public:
  BackEndWorker(std::unique_ptr<BackEnd> back_end, int lag, WorkerMode mode);

  /// Waits until it is known what frame number `n` may see: offline for frame n - lag, never live.
  /// Rethrows a failure of the thread.
  void wait_before(std::int64_t n);
  /// After that: the update that is there for frame number `n`, or nothing. Who takes it must make
  /// a revision of it.
  std::optional<history::Update> take_before(std::int64_t n);
  /// Queues the next tracked frame; every frame comes, in order, with the revision whose path ends
  /// with it. Live, frames that come faster than they can be looked at are passed over.
  void submit(std::shared_ptr<const RgbdFrame> frame, const tracker::TrackResult& result,
              const history::Revision& revision);
  /// Finishes what was queued and stops; returns the update that has not been taken yet, if there
  /// is one, or what is found at the end.
  std::optional<history::Update> finish(const history::Revision& revision);

  /// BackEnd::found() as frame number `n` may know it: of frame n - lag offline, the newest
  /// live (thread-safe).
  int found_before(std::int64_t n) const;

 private:
  struct Job {
    std::shared_ptr<const RgbdFrame> frame;
    tracker::TrackResult result;
    history::Revision revision;
  };
  LaggedWorker<Job>::Tasks tasks(WorkerMode mode);

  std::int64_t lag_;
  std::unique_ptr<BackEnd> back_end_;
  std::optional<history::Update> newest_;  // of the job at work
  // Guarded by the worker's lock:
  std::vector<int> counts_;               // found() after each job
  std::optional<history::Update> found_;  // not taken yet
  std::int64_t found_by_ = 0;             // number of the job

  LaggedWorker<Job> worker_;  // last: its thread uses all of the above
};

}  // namespace sgs::slam
