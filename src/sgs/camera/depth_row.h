// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace sgs {

/// A part of a row of a depth image between two rows of another one.
struct DepthRow {
  const float* top = nullptr;     ///< depth, m, 0 = none; where dx > 0 one more than are asked for
  const float* bottom = nullptr;  ///< the row below; the same one where dy = 0
  float dx = 0, dy = 0;           ///< 0 .. 1: where between the four pixels
  std::span<const float> offset_per_m;  ///< of inverse depth
};

/// Depth at each place of a row: inverse depth interpolated between four pixels of one surface,
/// that of the nearest one elsewhere, with its offset. 0 where nothing was measured and where the
/// offset moves a depth beyond 100 m.
void correct_depth(const DepthRow& row, float* corrected);

}  // namespace sgs
