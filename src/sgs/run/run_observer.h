// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "sgs/dataset/feed_item.h"
#include "sgs/refine/refiner.h"
#include "sgs/run/live_status.h"
#include "sgs/slam/session.h"

namespace sgs::run {

/// Who watches a run, from its first frame to its scores: overrides what it wants to know. All
/// calls come from the thread that runs; what they throw ends the run as any failure does.
class RunObserver {
 public:
  virtual ~RunObserver() = default;

  // Calibration of the input, where that comes first.
  virtual void on_calibration_frame() {}

  // Tracking and mapping.
  /// Before a frame is read; may hold the run (pause), and calls `held` at once and then many times
  /// a second while it does. Returns the seconds it was held.
  virtual double before_frame(const std::function<void()>& /*held*/) { return 0; }
  /// An item was fed; `record` is what came of it, also where the frame was bad. A run that is
  /// resumed feeds again what it had been fed before.
  virtual void on_frame(slam::Session& /*session*/, const dataset::FeedItem& /*item*/,
                        const slam::FrameRecord& /*record*/) {}
  /// Something happened to the input, beside frames; an empty text: all is well again.
  virtual void on_input_event(const std::string& /*what*/) {}
  /// How the run fares otherwise; a few times a second at most.
  virtual void on_status(const LiveStatus& /*now*/) {}
  /// Asked before each frame and while the run is held: whether what there is of map and trajectory
  /// is to be saved, and whether a recording is to begin (true) or to end.
  virtual bool take_save() { return false; }
  virtual std::optional<bool> take_recording() { return {}; }
  /// What came of take_save(); from a thread of its own.
  virtual void on_saved(const SaveNote& /*note*/) {}
  /// After the last frame, while the session can still be saved; not where something failed.
  virtual void on_last_frame() {}
  /// The session is finished: its map is final.
  virtual void on_map(slam::Session& /*session*/) {}

  // Refinement.
  /// So many frames of the recording have been read to learn from.
  virtual void on_frames_read(std::int64_t /*frames*/) {}
  virtual void on_evaluation(const refine::Evaluation& /*now*/) {}
  /// An evaluation found this map better than all before.
  virtual void on_better_map(const map::SplatMap& /*map*/) {}

  // Scoring.
  /// So many frames have been compared with the recording.
  virtual void on_frames_scored(std::int64_t /*frames*/) {}

  /// One who looks away.
  static RunObserver& nobody();
};

}  // namespace sgs::run
