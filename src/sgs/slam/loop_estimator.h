// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/loops/loop_closer.h"
#include "sgs/slam/past_estimator.h"
#include "sgs/slam/session_config.h"

namespace sgs::slam {

/// Closes loops. Frames come with their depth corrected.
class LoopEstimator final : public PastEstimator {
 public:
  explicit LoopEstimator(const SessionConfig& config)
      : closer_(config.loops, config.tracker, config.seed) {}

  std::shared_ptr<const PastCorrection> add(const std::shared_ptr<const RgbdFrame>& frame,
                                            const tracker::TrackResult& result) override;
  void note_applied(const PastCorrection& correction) override { closer_.note_applied(correction); }
  /// Loops in the graph.
  int found() const override { return static_cast<int>(closer_.skeleton().loops().size()); }

  const loops::LoopCloser& closer() const { return closer_; }

 private:
  loops::LoopCloser closer_;
};

}  // namespace sgs::slam
