// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/view_candidates.h"

#include <algorithm>

namespace sgs::mapper {

ViewCandidates::Visit ViewCandidates::next(std::size_t keyframe, std::size_t gaussians) {
  if (interval_ <= 1) return {};
  keep();
  if (keyframes_.size() <= keyframe) keyframes_.resize(keyframe + 1);
  Keyframe& own = keyframes_[keyframe];
  const bool looks_at_all = own.visits++ % interval_ == 0;
  if (looks_at_all || own.seen.size() < gaussians) noting_ = keyframe;
  own.seen.unpack(seen_);
  if (looks_at_all) return {nullptr, &seen_};
  return {&seen_, noting_ ? &seen_ : nullptr};
}

void ViewCandidates::keep() {
  if (!noting_) return;
  map::PackedSet& kept = keyframes_[*noting_].seen;
  bytes_ -= kept.bytes();
  kept = map::PackedSet(seen_);
  bytes_ += kept.bytes();
  noting_.reset();
}

void ViewCandidates::forget() {
  keyframes_.clear();
  bytes_ = 0;
  noting_.reset();
}

void ViewCandidates::forget(std::size_t keyframe) {
  if (keyframe >= keyframes_.size()) return;
  if (noting_ == keyframe) noting_.reset();
  map::PackedSet& seen = keyframes_[keyframe].seen;
  bytes_ -= seen.bytes();
  seen = map::PackedSet();
  bytes_ += seen.bytes();
}

void ViewCandidates::follow_removal(const map::GaussianSet& removed) {
  if (removed.count() == 0) return;
  keep();
  const map::Removal removal(removed);
  bytes_ = 0;
  for (Keyframe& keyframe : keyframes_) {
    keyframe.seen.follow_removal(removal);
    bytes_ += keyframe.seen.bytes();
  }
}

bool ViewCandidates::consistent(std::size_t keyframes, std::size_t gaussians) const {
  return keyframes_.size() <= keyframes &&
         std::all_of(keyframes_.begin(), keyframes_.end(), [&](const Keyframe& keyframe) {
           return keyframe.visits >= 0 && keyframe.seen.size() <= gaussians;
         });
}

}  // namespace sgs::mapper
