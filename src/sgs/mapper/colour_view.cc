// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/colour_view.h"

#include <algorithm>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs::mapper {
namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

}  // namespace

void colour_view(const render::Rendering& rendering, RgbdFrame& frame) {
  constexpr float kOpaque = 0.5f, kDark = 0.02f, kMostTimes = 2;
  SGS_CHECK(rendering.alpha.width() == frame.color.width() &&
                rendering.alpha.height() == frame.color.height(),
            "a rendering of the frame's size");
  auto seen = std::make_shared<PixelMask>(frame.color.width(), frame.color.height());
  for (int v = 0; v < frame.color.height(); ++v) {
    for (int u = 0; u < frame.color.width(); ++u) {
      const bool shown = rendering.alpha(u, v) >= kOpaque && frame.sees(u, v);
      (*seen)(u, v) = shown ? 1 : 0;
      if (!shown) continue;
      const render::Rgbf& c = rendering.color(u, v);
      const float rendered = 0.299f * c.r + 0.587f * c.g + 0.114f * c.b;
      const float measured = static_cast<float>(frame.color(u, v).g) / 255;
      const float times =
          std::clamp(measured / std::max(rendered, kDark), 1 / kMostTimes, kMostTimes);
      const float rest = measured - times * rendered;
      frame.color(u, v) = {to_byte(times * c.r + rest), to_byte(times * c.g + rest),
                           to_byte(times * c.b + rest)};
    }
  }
  frame.seen = std::move(seen);
}

}  // namespace sgs::mapper
