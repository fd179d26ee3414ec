// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/moving_blocks.h"

#include <algorithm>

namespace sgs::registration {
namespace {

// Of the elements the one that so large a share lies below; the order changes.
float quantile(std::vector<float>& values, double share) {
  const auto n = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * n);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

FlowVotes::FlowVotes(int width, int height)
    : columns_((width + MovingBlocks::kBlock_px - 1) / MovingBlocks::kBlock_px),
      rows_((height + MovingBlocks::kBlock_px - 1) / MovingBlocks::kBlock_px),
      flows_(static_cast<std::size_t>(columns_ * rows_)) {}

void FlowVotes::add(int u, int v, float flow_px) {
  const int block = v / MovingBlocks::kBlock_px * columns_ + u / MovingBlocks::kBlock_px;
  flows_[static_cast<std::size_t>(block)].push_back(flow_px);
}

// What most of the picture is off by is what the pose is off by, and is nobody's motion. It may be
// up to the share kStill of the blocks that stands still.
MovingBlocks FlowVotes::judge() const {
  constexpr std::size_t kEnough = 3, kEnoughBlocks = 12;
  constexpr double kStill = 0.35;
  constexpr float kTimes = 3, kLeast_px = 2.5f, kUnknown = -1;
  std::vector<float> medians(flows_.size(), kUnknown), known;
  for (std::size_t i = 0; i < flows_.size(); ++i) {
    if (flows_[i].size() < kEnough) continue;
    std::vector<float> flows = flows_[i];
    medians[i] = quantile(flows, 0.5);
    known.push_back(medians[i]);
  }
  if (known.size() < kEnoughBlocks) return {};
  const float limit = std::max(kLeast_px, kTimes * quantile(known, kStill));
  std::vector<std::uint8_t> moves(flows_.size(), 0);
  bool any = false;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const auto i = static_cast<std::size_t>(row * columns_ + column);
      bool moving = medians[i] > limit;
      if (medians[i] == kUnknown) {  // as most of its neighbours
        int balance = 0;
        for (int v = std::max(0, row - 1); v <= std::min(rows_ - 1, row + 1); ++v) {
          for (int u = std::max(0, column - 1); u <= std::min(columns_ - 1, column + 1); ++u) {
            const float median = medians[static_cast<std::size_t>(v * columns_ + u)];
            if (median != kUnknown) balance += median > limit ? 1 : -1;
          }
        }
        moving = balance > 0;
      }
      moves[i] = moving ? 1 : 0;
      any = any || moving;
    }
  }
  return any ? MovingBlocks(columns_, std::move(moves)) : MovingBlocks();
}

}  // namespace sgs::registration
