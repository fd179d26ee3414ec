// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "input.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/slam/live_feed.h"
#include "sgs/slam/session.h"

namespace sgs::app {

/// Frames and seconds of a run.
struct RunClock {
  std::int64_t frames_in = 0;       ///< frames the source gave, bad ones included
  std::int64_t frames_dropped = 0;  ///< --realtime only
  double wall_s = 0;     ///< from the first frame to the finished map, pauses not counted
  double starved_s = 0;  ///< of it, waiting for a decoded frame while tracker and mapper were idle
};

/// Somebody who watches a run, frame by frame, on the thread that feeds it.
class Spectator {
 public:
  virtual ~Spectator() = default;
  /// Before a frame is read; may hold the run (pause). Returns the seconds it was held.
  virtual double before_frame() = 0;
  /// After `item` was fed and gave `record`.
  virtual void after_frame(slam::Session& session, const slam::FeedItem& item,
                           const slam::FrameRecord& record) = 0;
};

/// How to play an input into a session.
struct PlayOptions {
  bool realtime = false;
  bool quiet = false;
  dataset::TumSequenceWriter* recorder = nullptr;  ///< keeps every frame fed; null = none
  Spectator* spectator = nullptr;                  ///< null = nobody watches
};

/// Feeds the whole input into the session (until Ctrl-C) and waits for the mapper to finish.
/// Fails when the recorder cannot write; the session is finished all the same.
Result<RunClock> play(Input& input, slam::Session& session, const PlayOptions& options);

}  // namespace sgs::app
