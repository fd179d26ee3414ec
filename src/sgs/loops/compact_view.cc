// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/compact_view.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/pyramid.h"

namespace sgs::loops {
namespace {

constexpr float kUnitsPerMetre = 5000;

}  // namespace

CompactView::CompactView(const RgbdFrame& frame)
    : camera_(frame.camera),
      index_(frame.index),
      timestamp_s_(frame.timestamp_s),
      gray_(frame.color.width(), frame.color.height()),
      depth_(frame.depth.width(), frame.depth.height()) {
  GrayPyramid pyramid;
  pyramid.build(frame.color, frame.camera, 1);
  const Image<float>& gray = pyramid.level(0).gray;
  for (std::size_t i = 0; i < gray_.size(); ++i) {
    gray_.data()[i] = static_cast<std::uint8_t>(std::lround(gray.data()[i]));
  }
  for (std::size_t i = 0; i < depth_.size(); ++i) {
    const float units = std::round(frame.depth.data()[i] * kUnitsPerMetre);
    depth_.data()[i] = units < 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
  }
}

RgbdFrame CompactView::frame() const {
  RgbdFrame out;
  out.index = index_;
  out.timestamp_s = timestamp_s_;
  out.camera = camera_;
  out.color = ColorImage(gray_.width(), gray_.height());
  out.depth = DepthImage(depth_.width(), depth_.height());
  for (std::size_t i = 0; i < gray_.size(); ++i) {
    const std::uint8_t g = gray_.data()[i];
    out.color.data()[i] = {g, g, g};
  }
  for (std::size_t i = 0; i < depth_.size(); ++i) {
    out.depth.data()[i] = static_cast<float>(depth_.data()[i]) / kUnitsPerMetre;
  }
  return out;
}

}  // namespace sgs::loops
