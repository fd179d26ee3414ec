// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/pair_rectifier.h"

#include <utility>

namespace sgs {

void PairRectifier::prepare() {
  if (std::exchange(ready_, true)) return;
  if (!color_.distortion.is_zero()) undistorter_.emplace(color_.camera, color_.distortion);
  if (depth_) registration_.emplace(*depth_, LensCamera{color_.camera, {}}, T_color_depth_);
}

PixelMask PairRectifier::rectify(PixelMask mask, std::uint8_t outside) {
  prepare();
  if (!undistorter_) return mask;
  PixelMask out = undistorter_->mask(mask);
  const PixelMask* seen = undistorter_->seen().get();
  for (std::size_t i = 0; seen != nullptr && i < out.size(); ++i) {
    if (seen->data()[i] == 0) out.data()[i] = outside;
  }
  return out;
}

void PairRectifier::rectify(ColorImage color, DepthImage depth, RgbdFrame& frame) {
  prepare();
  frame.seen = undistorter_ ? undistorter_->seen() : nullptr;
  frame.color = undistorter_ ? undistorter_->color(color) : std::move(color);
  if (registration_) {
    frame.depth = (*registration_)(depth);
  } else {
    frame.depth = undistorter_ ? undistorter_->depth(depth) : std::move(depth);
  }
}

}  // namespace sgs
