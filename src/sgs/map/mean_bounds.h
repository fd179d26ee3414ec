// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "sgs/map/gaussian.h"

namespace sgs::map {

/// Boxes around the means of every kBlock consecutive Gaussians, so that a renderer passes over
/// whole blocks out of its view. Neighbours in space are neighbours in memory, which keeps them
/// small. A box may be too large, never too small.
class MeanBounds {
 public:
  static constexpr std::size_t kBlock = 64;
  struct Box {
    float low[3], high[3];  ///< world, metres; low > high while nothing is inside
  };

  /// Makes the boxes of all of `gaussians` afresh, around their means in both arrays.
  void assign(std::span<const Gaussian> gaussians, std::span<const Gaussian> also);
  /// Takes in the Gaussians from number size() on; those before are as they were.
  void append(std::span<const Gaussian> gaussians);
  /// Takes in the place to which Gaussian number `index` has moved. Thread-safe for different
  /// blocks.
  void widen(std::size_t index, const Gaussian& gaussian) {
    Box& box = boxes_[index / kBlock];
    for (int k = 0; k < 3; ++k) {
      // The first argument stays when the second is not a number.
      box.low[k] = std::min(box.low[k], gaussian.mean[k]);
      box.high[k] = std::max(box.high[k], gaussian.mean[k]);
    }
  }

  std::size_t size() const { return size_; }  ///< Gaussians
  std::span<const Box> boxes() const { return boxes_; }

 private:
  std::size_t size_ = 0;
  std::vector<Box> boxes_;
};

}  // namespace sgs::map
