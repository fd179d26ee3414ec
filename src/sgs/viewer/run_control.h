// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>

namespace sgs::viewer {

/// What is to follow the end of a run that a client asked for.
enum class AfterRun { kNothing, kRefine, kStartAgain };

/// What clients wish of a run, between the page and the loop that feeds frames. Of wishes that
/// contradict each other the last one counts; the same once more changes nothing. Thread-safe.
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

  /// The frames are to end properly, also while the run is paused; what follows may be wished anew
  /// until the run has ended.
  void finish(AfterRun after);
  /// Requested by finish().
  std::stop_token finished() const { return finish_.get_token(); }
  /// The newest wish for what follows; with it, it has been heard.
  AfterRun take_after();
  AfterRun after() const;

  /// What there is of the run is to be saved.
  void ask_save() { save_ = true; }
  bool take_save() { return save_.exchange(false); }
  /// A recording is to begin or to end.
  void set_recording(bool on);
  std::optional<bool> take_recording();

  /// Called by the loop before each frame: waits while paused until a step or resume() lets it go
  /// on, finish() ends the frames, or `stop` (asked every 50 ms) says that the program is to end.
  /// Returns the seconds waited.
  double wait_turn(const std::function<bool()>& stop);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_ = false;
  bool step_ = false;
  std::atomic<bool> refinement_ = false;  // asked for also while mutex_ is held
  std::atomic<bool> save_ = false;
  std::optional<bool> recording_;
  AfterRun after_ = AfterRun::kNothing;
  std::stop_source finish_;
};

}  // namespace sgs::viewer
