// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/panes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace sgs::viewer {
namespace {

/// Colours of equal distance in lightness, dark blue to yellow.
Rgb8 scale_color(float t) {
  static constexpr std::array<std::array<float, 3>, 5> kStops = {{{0.05f, 0.03f, 0.30f},
                                                                  {0.35f, 0.10f, 0.55f},
                                                                  {0.75f, 0.25f, 0.45f},
                                                                  {0.95f, 0.55f, 0.25f},
                                                                  {0.97f, 0.95f, 0.35f}}};
  const float position = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(kStops.size() - 1);
  const auto k = std::min(static_cast<std::size_t>(position), kStops.size() - 2);
  const float share = position - static_cast<float>(k);
  const auto channel = [&](std::size_t c) {
    return to_byte((1 - share) * kStops[k][c] + share * kStops[k + 1][c]);
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace

ColorImage shrink(const ColorImage& image, int stride) {
  SGS_CHECK(stride >= 1, "stride must be positive");
  if (stride == 1) return image;
  ColorImage out(image.width() / stride, image.height() / stride);
  const int count = stride * stride;
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      int r = count / 2, g = count / 2, b = count / 2;
      for (int dy = 0; dy < stride; ++dy) {
        const Rgb8* row = image.row(y * stride + dy) + x * stride;
        for (int dx = 0; dx < stride; ++dx) {
          r += row[dx].r;
          g += row[dx].g;
          b += row[dx].b;
        }
      }
      out(x, y) = {static_cast<std::uint8_t>(r / count), static_cast<std::uint8_t>(g / count),
                   static_cast<std::uint8_t>(b / count)};
    }
  }
  return out;
}

namespace {

template <class T>
Image<T> thinned(const Image<T>& image, int stride) {
  SGS_CHECK(stride >= 1, "stride must be positive");
  Image<T> out(image.width() / stride, image.height() / stride);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) out(x, y) = image(x * stride, y * stride);
  }
  return out;
}

}  // namespace

DepthImage shrink(const DepthImage& image, int stride) { return thinned(image, stride); }

PixelMask shrink(const PixelMask& mask, int stride) { return thinned(mask, stride); }

void veil(ColorImage& image, const PixelMask& seen) {
  constexpr Rgb8 kVeil = {40, 40, 40};
  for (std::size_t i = 0; i < seen.size() && i < image.size(); ++i) {
    if (seen.data()[i] == 0) image.data()[i] = kVeil;
  }
}

void outline(ColorImage& image, const PixelMask& still) {
  SGS_CHECK(image.width() == still.width() && image.height() == still.height(),
            "a mask of the picture's size");
  constexpr Rgb8 kLine = {255, 140, 0};
  constexpr int kWidth_px = 2;
  const auto touches_still = [&](int u, int v) {
    for (int y = v - kWidth_px; y <= v + kWidth_px; ++y) {
      for (int x = u - kWidth_px; x <= u + kWidth_px; ++x) {
        if (still.contains(x, y) && still(x, y) != 0) return true;
      }
    }
    return false;
  };
  for (int v = 0; v < still.height(); ++v) {
    for (int u = 0; u < still.width(); ++u) {
      if (still(u, v) == 0 && touches_still(u, v)) image(u, v) = kLine;
    }
  }
}

ColorImage depth_picture(const DepthImage& depth) {
  constexpr float kNear_m = 0.3f, kFar_m = 10.0f;
  const float range = std::log(kFar_m / kNear_m);
  ColorImage out(depth.width(), depth.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float z = depth.data()[i];
    if (z > 0) out.data()[i] = scale_color(1 - std::log(z / kNear_m) / range);
  }
  return out;
}

ColorImage color_picture(const Image<render::Rgbf>& color) {
  ColorImage out(color.width(), color.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const render::Rgbf& c = color.data()[i];
    out.data()[i] = {to_byte(c.r), to_byte(c.g), to_byte(c.b)};
  }
  return out;
}

ColorImage error_picture(const ColorImage& measured, const ColorImage& rendered) {
  SGS_CHECK(measured.width() == rendered.width() && measured.height() == rendered.height(),
            "pictures of different size");
  constexpr float kFullScale = 0.25f * 3 * 255;
  ColorImage out(measured.width(), measured.height());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Rgb8 &a = measured.data()[i], &b = rendered.data()[i];
    const float sum =
        static_cast<float>(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b));
    const float share = std::min(1.0f, sum / kFullScale);
    out.data()[i] = {to_byte(share), to_byte(0.9f * share), to_byte(0.2f * share)};
  }
  return out;
}

}  // namespace sgs::viewer
