// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/second_look_back_end.h"

#include <utility>

namespace sgs::slam {

std::optional<history::Update> SecondLookBackEnd::add(const std::shared_ptr<const RgbdFrame>& frame,
                                                      const tracker::TrackResult& result,
                                                      const history::Revision& revision) {
  // Depth that is corrected otherwise does not go together.
  const bool other_depth = std::exchange(calibration_, revision.calibration) != calibration_;
  const bool lost = result.status == tracker::TrackingStatus::kLost || !result.information;
  if (other_depth || lost) look_.forget();
  if (lost) return std::nullopt;
  look_.see(frame, result);
  const bool in_flight = revision.second_looks < found_;
  if (in_flight) return std::nullopt;
  auto poses = look_.look_back(revision.path);
  if (!poses) return std::nullopt;
  ++found_;
  return history::Update{.poses = std::move(*poses), .tracked_anew = true};
}

}  // namespace sgs::slam
