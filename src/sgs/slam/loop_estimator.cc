// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/loop_estimator.h"

#include <utility>

namespace sgs::slam {

std::shared_ptr<const PastCorrection> LoopEstimator::add(
    const std::shared_ptr<const RgbdFrame>& frame, const tracker::TrackResult& result) {
  auto correction = closer_.add(*frame, result);
  return correction ? std::make_shared<const PastCorrection>(std::move(*correction)) : nullptr;
}

}  // namespace sgs::slam
