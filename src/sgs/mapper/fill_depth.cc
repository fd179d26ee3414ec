// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "sgs/mapper/insertion.h"

namespace sgs::mapper {
namespace {

/// Fills the zeros of a strided line with the farther of its nearest non-zero neighbours.
void fill_line(float* values, int count, std::ptrdiff_t stride, std::vector<float>& before) {
  before.assign(static_cast<std::size_t>(count), 0.0f);
  float last = 0;
  for (int i = 0; i < count; ++i) {
    if (values[i * stride] > 0) last = values[i * stride];
    before[static_cast<std::size_t>(i)] = last;
  }
  last = 0;
  for (int i = count - 1; i >= 0; --i) {
    if (values[i * stride] > 0) {
      last = values[i * stride];
    } else {
      values[i * stride] = std::max(before[static_cast<std::size_t>(i)], last);
    }
  }
}

}  // namespace

FilledDepth fill_depth(const MapKeyframe& keyframe, bool fill) {
  const int width = keyframe.camera().width, height = keyframe.camera().height;
  FilledDepth filled{DepthImage(width, height), Image<std::uint8_t>(width, height, 0)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) filled.depth(x, y) = keyframe.depth_m(x, y);
  }
  if (!fill) return filled;
  for (std::size_t i = 0; i < filled.depth.size(); ++i) {
    filled.borrowed.data()[i] = filled.depth.data()[i] <= 0 ? 1 : 0;
  }
  std::vector<float> scratch;
  for (int y = 0; y < height; ++y) fill_line(filled.depth.row(y), width, 1, scratch);
  for (int x = 0; x < width; ++x) fill_line(filled.depth.data() + x, height, width, scratch);
  return filled;
}

}  // namespace sgs::mapper
