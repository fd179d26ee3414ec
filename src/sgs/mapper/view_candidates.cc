// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/view_candidates.h"

#include <algorithm>

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

bool ViewCandidates::consistent(std::size_t keyframes, std::size_t gaussians) const {
  return keyframes_.size() <= keyframes &&
         std::all_of(keyframes_.begin(), keyframes_.end(), [&](const Keyframe& keyframe) {
           return keyframe.visits >= 0 && keyframe.seen.size() <= gaussians;
         });
}

}  // namespace sgs::mapper
