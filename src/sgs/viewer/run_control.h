// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>

namespace sgs::viewer {

/// Pause, resume, step and the wish for a refinement, between the page and the loop that feeds
/// frames. Thread-safe.
class RunControl {
 public:
  void pause();
  void resume();
  /// Lets one more frame pass and pauses after it.
  void step();
  bool paused() const;
  /// A client wants the map refined; while it is, that it ends.
  void ask_refinement();
  bool refinement_asked() const;
  /// Whether it was asked for since the last call.
  bool take_refinement();

  /// Called by the loop before each frame: waits while paused until a step or resume() lets it go
  /// on or `stop` (asked every 50 ms) says that the program is to end. Returns the seconds waited.
  double wait_turn(const std::function<bool()>& stop);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_ = false;
  bool step_ = false;
  std::atomic<bool> refinement_ = false;  // asked for also while mutex_ is held
};

}  // namespace sgs::viewer
