// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "sgs/loops/loop_closer.h"
#include "sgs/slam/back_end.h"
#include "sgs/slam/session_config.h"

namespace sgs::slam {

/// How loops align views: as the tracker does.
loops::PairConfig pair_config(const tracker::TrackerConfig& tracker);
/// What loops ask of a tracked frame.
loops::TrackedFrame tracked_frame(const tracker::TrackResult& result);

/// Closes loops. Frames come with their depth corrected and are remembered as delivered.
class LoopBackEnd final : public BackEnd {
 public:
  LoopBackEnd(const SessionConfig& config, std::shared_ptr<history::ViewStore> views)
      : closer_(config.loops, pair_config(config.tracker), config.seed, std::move(views)) {}

  std::optional<history::Update> add(const std::shared_ptr<const RgbdFrame>& frame,
                                     const tracker::TrackResult& result,
                                     const history::Revision& revision) override;
  /// Loops in the graph.
  int found() const override { return static_cast<int>(closer_.pose_graph().loops().size()); }

  const loops::LoopCloser& closer() const { return closer_; }
  /// To be told of a map before the first frame.
  loops::LoopCloser& closer() { return closer_; }

 private:
  loops::LoopCloser closer_;
};

}  // namespace sgs::slam
