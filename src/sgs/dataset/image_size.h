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

/// Whether both can be the same view: equal shapes, up to a pixel of rounding in the smaller one.
inline bool same_shape(ImageSize a, ImageSize b) {
  if (!a.known() || !b.known()) return false;
  if (a.width < b.width) std::swap(a, b);
  const double height = static_cast<double>(a.height) * b.width / a.width;
  return std::abs(height - b.height) <= 1;
}

}  // namespace sgs::dataset
