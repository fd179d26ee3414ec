// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/loop_back_end.h"

#include <utility>

namespace sgs::slam {

loops::PairConfig pair_config(const tracker::TrackerConfig& tracker) {
  return {tracker::aligner_config(tracker), tracker.orb, tracker.visual_pose};
}

loops::TrackedFrame tracked_frame(const tracker::TrackResult& result) {
  return {result.status == tracker::TrackingStatus::kLost, result.information, result.motion};
}

std::optional<history::Update> LoopBackEnd::add(const std::shared_ptr<const RgbdFrame>& frame,
                                                const tracker::TrackResult& result,
                                                const history::Revision& revision) {
  auto poses = closer_.add(*frame, tracked_frame(result), revision);
  if (!poses) return std::nullopt;
  return history::Update{std::move(*poses)};
}

}  // namespace sgs::slam
