// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "sgs/run/frame_recorder.h"
#include "sgs/run/run_observer.h"
#include "sgs/runfolder/input_event.h"
#include "sgs/slam/session.h"

namespace sgs::run {

/// Frames and seconds of a run.
struct RunClock {
  std::int64_t frames_in = 0;        ///< frames the source gave, bad ones included
  std::size_t frames_replayed = 0;   ///< of these before the run went on; in none of the times
  std::int64_t frames_dropped = 0;   ///< live only
  std::int64_t frames_left_out = 0;  ///< live only: came while the run was held; in no other number
  double wall_s = 0;     ///< from the first frame to the finished map, pauses not counted
  double starved_s = 0;  ///< of it, waiting for a decoded frame while tracker and mapper were idle
  std::vector<InputEvent> events;  ///< of a live input
};

/// How to play a source into a session.
struct PlayOptions {
  bool realtime = false;              ///< at the sensor's rate, late frames dropped
  FrameRecorder* recorder = nullptr;  ///< is offered every frame, also those that are dropped
  std::stop_token enough = {};        ///< the frames end here, as if there were no more
};

/// Feeds the whole source into the session (until a stop is requested) and waits for the mapper to
/// finish. While an observer holds it, frames at the sensor's rate are left out, and not recorded;
/// other sources wait. Fails when the input broke off, or something threw (memory, a broken
/// contract); the session is finished all the same and holds what was made of the frames so far.
Result<RunClock> play(dataset::FrameSource& source, slam::Session& session,
                      const PlayOptions& options, RunObserver& observer = RunObserver::nobody(),
                      const std::stop_token& stop = {});

/// Feeds a restored session the first items of its source again until it is where it was
/// (slam::Session::restore()). Fails where the source gives
/// other frames than before, and where a stop is requested on the way: the session is of no use
/// then.
Status replay(dataset::FrameSource& source, slam::Session& session, RunObserver& observer,
              const std::stop_token& stop = {});

}  // namespace sgs::run
