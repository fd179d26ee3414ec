// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/rendered_images.h"

namespace sgs::render {

ColorImage to_color_image(const Image<Rgbf>& color) {
  ColorImage out(color.width(), color.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Rgbf& c = color.data()[i];
    out.data()[i] = {to_byte(c.r), to_byte(c.g), to_byte(c.b)};
  }
  return out;
}

DepthImage mean_depth(const Rendering& rendering, float min_alpha) {
  DepthImage out(rendering.alpha.width(), rendering.alpha.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float alpha = rendering.alpha.data()[i];
    if (alpha > min_alpha) out.data()[i] = rendering.depth_sum.data()[i] / alpha;
  }
  return out;
}

}  // namespace sgs::render
