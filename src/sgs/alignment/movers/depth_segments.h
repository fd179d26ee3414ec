// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sgs::alignment {

/// Parts of a depth picture that hang together.
struct DepthSegments {
  static constexpr std::int16_t kNone = -1;
  struct Border {
    std::size_t a, b;  ///< segments, a < b
    float length;      ///< pairs of cells across it that lie on one surface
  };
  int count = 0;
  std::vector<std::int16_t> of;  ///< of each cell; kNone where nothing is measured
  std::vector<Border> borders;   ///< where two touch in space
};

/// Divides a picture of `columns` cells a row, given the depth of each (metres, 0 = not measured).
/// (Local k-means: Achanta et al., SLIC Superpixels, TPAMI 2012, with depth in place of colour.)
/// Deterministic.
DepthSegments segment_depth(const std::vector<float>& depth, int columns);

}  // namespace sgs::alignment
