// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/view_candidates.h"

namespace sgs::mapper {

ViewCandidates::Visit ViewCandidates::next(std::size_t keyframe, std::size_t gaussians) {
  if (interval_ <= 1) return {};
  if (keyframes_.size() <= keyframe) keyframes_.resize(keyframe + 1);
  Keyframe& own = keyframes_[keyframe];
  const bool looks_at_all = own.visits++ % interval_ == 0;
  if (looks_at_all) return {nullptr, &own.seen};
  return {&own.seen, own.seen.size() < gaussians ? &own.seen : nullptr};
}

void ViewCandidates::follow_removal(const map::GaussianSet& removed) {
  if (removed.count() == 0) return;
  for (Keyframe& keyframe : keyframes_) keyframe.seen.follow_removal(removed);
}

}  // namespace sgs::mapper
