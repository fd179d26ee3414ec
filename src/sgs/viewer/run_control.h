// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>

namespace sgs::viewer {

/// Pause, resume and step, between the page and the loop that feeds frames. Thread-safe.
class RunControl {
 public:
  void pause();
  void resume();
  /// Lets one more frame pass and pauses after it.
  void step();
  bool paused() const;

  /// Called by the loop before each frame: waits while paused until a step or resume() lets it go
  /// on or `stop` (asked every 50 ms) says that the program is to end. Returns the seconds waited.
  double wait_turn(const std::function<bool()>& stop);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_ = false;
  bool step_ = false;
};

}  // namespace sgs::viewer
