// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

namespace sgs {

/// Fork-join pool for loops over a fixed number of chunks.
///
/// Results must not depend on which worker runs a chunk or in which order: give every chunk its own
/// output slot and add the slots up afterwards in chunk order (see docs/architecture.md,
/// determinism). Own code rather than TBB because an uninstrumented TBB makes ThreadSanitizer
/// report false races, and fork-join over an atomic counter is all that is needed.
class ThreadPool {
 public:
  /// `threads` >= 1 counts the calling thread; 1 runs everything inline. The other threads run at a
  /// priority lower by `nice` (lower_thread_priority), so that they only take what others leave.
  explicit ThreadPool(int threads, int nice = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;

  /// Calls `body(chunk, worker)` once for each chunk in [0, chunks), worker in [0, threads()), and
  /// returns when all are done. The first exception thrown by a body is rethrown here. Must not be
  /// called from inside a body, nor from two threads at once.
  void run(int chunks, const std::function<void(int chunk, int worker)>& body);

  /// While it lives the last of the pool's threads takes no chunks. For a thread that is about to
  /// compute on a machine whose cores the pool fills: it would otherwise interrupt a thread of the
  /// pool in the middle of a chunk, for which the whole loop would then wait. Whoever makes one
  /// sleeps until the chunk in hand is done, though not longer than a millisecond. Pools of one
  /// thread know no recess. May be made from any thread, and several at once.
  class Recess {
   public:
    explicit Recess(ThreadPool& pool);
    ~Recess();
    Recess(const Recess&) = delete;
    Recess& operator=(const Recess&) = delete;

   private:
    ThreadPool& pool_;
  };

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sgs
