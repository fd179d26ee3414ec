// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include "sgs/dataset/feed_item.h"
#include "sgs/run/live_status.h"
#include "sgs/run/run_observer.h"

namespace sgs::run {

/// What only whoever plays a source knows.
struct FeedCounts {
  std::size_t delivered = 0;  ///< frames that came
  std::size_t dropped = 0;    ///< of these, too fast
  std::size_t left_out = 0;   ///< beside them, while the run was held
};

/// Tells an observer how a run at the camera's rate fares, a few times a second; and the log, once
/// each, what the one who holds the camera can do better.
class StatusTeller {
 public:
  /// `watches`: a camera is held by somebody who can do better; else it is a recording. `recorder`
  /// may be null.
  StatusTeller(RunObserver& observer, const PinholeCamera& camera, bool at_camera_rate,
               bool watches, const FrameRecorder* recorder);

  /// A frame was tracked.
  void frame(const dataset::FeedItem& item, const slam::FrameRecord& record,
             const FeedCounts& counts, const std::string& trouble);
  /// No frame, but time passes: the run is held, or something happened to the input.
  void moment(const FeedCounts& counts, const std::string& trouble);
  /// The run was held.
  void gap();

 private:
  void watch(const RgbdFrame& frame, const slam::FrameRecord& record);
  void tell(const FeedCounts& counts, const std::string& trouble, bool now);
  double rate(const FeedCounts& counts, double now_s);

  struct Sample {
    double time_s;
    std::size_t delivered;
  };
  RunObserver& observer_;
  const FrameRecorder* recorder_;
  slam::SceneWatch watch_;
  bool watches_;
  LiveStatus status_;
  std::deque<Sample> samples_;  // of the last seconds
  double told_s_ = 0;
};

}  // namespace sgs::run
