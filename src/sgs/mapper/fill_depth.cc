// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sgs/mapper/insertion.h"

namespace sgs::mapper {
namespace {

/// Fills the zeros of a row with the farther of their nearest non-zero neighbours.
void fill_row(float* values, int count, std::vector<float>& before) {
  float last = 0;
  for (int i = 0; i < count; ++i) {
    if (values[i] > 0) last = values[i];
    before[static_cast<std::size_t>(i)] = last;
  }
  last = 0;
  for (int i = count - 1; i >= 0; --i) {
    if (values[i] > 0) {
      last = values[i];
    } else {
      values[i] = std::max(before[static_cast<std::size_t>(i)], last);
    }
  }
}

/// After fill_row() a row is full or empty: empty ones take the farther of the pixels above and
/// below, row by row, since walking down columns would miss the cache at every step.
void fill_empty_rows(DepthImage& depth) {
  const int height = depth.height();
  const auto empty = [&](int y) { return depth.width() > 0 && !(depth(0, y) > 0); };
  for (int y = 0; y < height; ++y) {
    if (!empty(y)) continue;
    int end = y;  // rows [y, end) are empty
    while (end < height && empty(end)) ++end;
    const float* above = y > 0 ? depth.row(y - 1) : nullptr;
    const float* below = end < height ? depth.row(end) : nullptr;
    for (int x = 0; x < depth.width(); ++x) {
      const float z = std::max(above ? above[x] : 0.0f, below ? below[x] : 0.0f);
      for (int row = y; row < end; ++row) depth(x, row) = z;
    }
    y = end;
  }
}

}  // namespace

FilledDepth fill_depth(const KeyframePictures& pictures, bool fill) {
  const int width = pictures.depth.width(), height = pictures.depth.height();
  FilledDepth filled{pictures.depth, Image<std::uint8_t>(width, height, 0)};
  if (!fill) return filled;
  for (std::size_t i = 0; i < filled.depth.size(); ++i) {
    filled.borrowed.data()[i] = filled.depth.data()[i] <= 0 ? 1 : 0;
  }
  std::vector<float> scratch(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) fill_row(filled.depth.row(y), width, scratch);
  fill_empty_rows(filled.depth);
  for (int y = 0; pictures.seen && y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!pictures.sees(x, y)) filled.depth(x, y) = 0;
    }
  }
  return filled;
}

}  // namespace sgs::mapper
