// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/sparse_steps.h"

#include <algorithm>
#include <numeric>

namespace sgs::mapper {

std::span<const std::uint8_t> SparseSteps::frozen(std::span<const std::uint32_t> steps,
                                                  std::int64_t iteration) {
  if (freeze_after_ == 0 || iteration % freeze_interval_ == 0) return {};
  frozen_.resize(steps.size());
  std::transform(steps.begin(), steps.end(), frozen_.begin(), [this](std::uint32_t n) {
    return static_cast<std::uint8_t>(n >= freeze_after_ ? 1 : 0);
  });
  return frozen_;
}

std::span<const std::uint8_t> SparseSteps::tiles(std::size_t keyframe, int level) {
  if (tile_floor_ <= 0) return {};
  if (visits_.size() <= keyframe) visits_.resize(keyframe + 1);
  Visits& own = visits_[keyframe][static_cast<std::size_t>(level)];
  own.masked = !own.masked && !own.last_loss.empty();
  if (!own.masked) return {};
  const float mean = std::accumulate(own.last_loss.begin(), own.last_loss.end(), 0.0f) /
                     static_cast<float>(own.last_loss.size());
  tiles_.resize(own.last_loss.size());
  std::transform(own.last_loss.begin(), own.last_loss.end(), tiles_.begin(), [&](float loss) {
    return static_cast<std::uint8_t>(loss >= tile_floor_ * mean ? 1 : 0);
  });
  return tiles_;
}

std::vector<float>* SparseSteps::tile_loss(std::size_t keyframe, int level) {
  if (tile_floor_ <= 0) return nullptr;
  Visits& own = visits_[keyframe][static_cast<std::size_t>(level)];
  return own.masked ? nullptr : &own.last_loss;
}

}  // namespace sgs::mapper
