// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/loop_back_end.h"

#include <utility>

namespace sgs::slam {

std::optional<history::Update> LoopBackEnd::add(const std::shared_ptr<const RgbdFrame>& frame,
                                                const tracker::TrackResult& result,
                                                const history::Revision& revision) {
  auto poses = closer_.add(*frame, result, revision);
  if (!poses) return std::nullopt;
  return history::Update{std::move(*poses)};
}

}  // namespace sgs::slam
