// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sgs/mapper/mapper_config.h"

namespace sgs::mapper {

/// What a step may leave out because it is thought to be good enough: Gaussians that have had many
/// steps, and tiles of a keyframe with little error. Both come back at regular intervals, since
/// what is left alone for ever is never seen to be wrong.
class SparseSteps {
 public:
  explicit SparseSteps(const ScheduleConfig& config)
      : freeze_after_(static_cast<std::uint32_t>(config.freeze_after_steps)),
        freeze_interval_(config.freeze_interval),
        tile_floor_(static_cast<float>(config.tile_loss_floor)) {}

  /// EvaluateOptions::frozen for step number `iteration`; `steps` of each Gaussian. Valid until the
  /// next call.
  std::span<const std::uint8_t> frozen(std::span<const std::uint32_t> steps,
                                       std::int64_t iteration);

  /// EvaluateOptions::tiles for the next visit of a keyframe at a level (0 or 1): every second
  /// visit is of all tiles. Valid until the next call.
  std::span<const std::uint8_t> tiles(std::size_t keyframe, int level);
  /// Where that visit is to leave the tiles' losses; null when they are not wanted.
  std::vector<float>* tile_loss(std::size_t keyframe, int level);

 private:
  struct Visits {
    bool masked = false;           ///< the present visit is not of all tiles
    std::vector<float> last_loss;  ///< per tile at the last full visit
  };

  std::uint32_t freeze_after_;
  int freeze_interval_;
  float tile_floor_;
  std::vector<std::uint8_t> frozen_, tiles_;
  std::vector<std::array<Visits, 2>> visits_;
};

}  // namespace sgs::mapper
