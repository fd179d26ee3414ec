// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "input.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/slam/session.h"

namespace sgs::app {

/// Frames and seconds of a run.
struct RunClock {
  std::int64_t frames_in = 0;       ///< frames the source gave, bad ones included
  std::int64_t frames_dropped = 0;  ///< --realtime only
  double wall_s = 0;                ///< from the first frame to the finished map
  double starved_s = 0;  ///< of it, waiting for a decoded frame while tracker and mapper were idle
};

/// How to play an input into a session.
struct PlayOptions {
  bool realtime = false;
  bool quiet = false;
  dataset::TumSequenceWriter* recorder = nullptr;  ///< keeps every frame fed; null = none
};

/// Feeds the whole input into the session (until Ctrl-C) and waits for the mapper to finish.
/// Fails when the recorder cannot write; the session is finished all the same.
Result<RunClock> play(Input& input, slam::Session& session, const PlayOptions& options);

}  // namespace sgs::app
