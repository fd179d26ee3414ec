// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace sgs {

/// Width or height of a camera as a file gives it, pixels: 0, which no camera has, where that is no
/// whole number up to a million.
inline int image_side_px(double value) {
  constexpr double kMost = 1e6;
  return value >= 0 && value <= kMost && value == std::floor(value) ? static_cast<int>(value) : 0;
}

}  // namespace sgs
