// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>

namespace sgs::dataset {

/// Width and height of images; 0 = not known.
struct ImageSize {
  int width = 0, height = 0;
  bool known() const { return width > 0 && height > 0; }
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// Whether both can be the same view: equal shapes, up to a pixel of rounding in the smaller one. A
/// few pixels are no view.
inline bool same_shape(ImageSize a, ImageSize b) {
  constexpr int kFewest_px = 8;
  if (!a.known() || !b.known()) return false;
  if (a.width < b.width) std::swap(a, b);
  if (a != b && (b.width < kFewest_px || b.height < kFewest_px)) return false;
  const double height = static_cast<double>(a.height) * b.width / a.width;
  return std::abs(height - b.height) <= 1;
}

}  // namespace sgs::dataset
