// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace sgs::registration {

/// Square parts of a picture in which something moves by itself. None by default.
class MovingBlocks {
 public:
  static constexpr int kBlock_px = 32;

  MovingBlocks() = default;
  /// `moves`: one a block, row by row.
  MovingBlocks(int columns, std::vector<std::uint8_t> moves)
      : columns_(columns), moves_(std::move(moves)) {}

  bool any() const { return !moves_.empty(); }
  /// Of the block around a pixel, which lies in the picture.
  bool at(int u, int v) const {
    return any() && moves_[static_cast<std::size_t>(v / kBlock_px * columns_ + u / kBlock_px)] != 0;
  }

 private:
  int columns_ = 0;
  std::vector<std::uint8_t> moves_;
};

/// Tells from how far off pixels are where something moves: what is off much farther than most of
/// the picture. (Scores of clusters that are solved beside the pose: Scona et al., StaticFusion,
/// ICRA 2018; here of square blocks and either 0 or 1.)
class FlowVotes {
 public:
  /// For a picture of that size.
  FlowVotes(int width, int height);

  /// A pixel of the picture appears to be off by so many pixels.
  void add(int u, int v, float flow_px);
  /// What follows from all of them.
  MovingBlocks judge() const;

 private:
  int columns_, rows_;
  std::vector<std::vector<float>> flows_;  // of each block
};

}  // namespace sgs::registration
