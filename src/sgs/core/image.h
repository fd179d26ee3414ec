// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sgs/core/error.h"

namespace sgs {

/// Dense row-major image that owns its pixels, without row padding. T is a plain pixel type.
template <class T>
class Image {
 public:
  Image() = default;
  /// Allocates `width` x `height` pixels, each set to `value`.
  Image(int width, int height, T value = T{})
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {
    SGS_CHECK(width >= 0 && height >= 0, "image size must not be negative");
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  std::size_t size() const { return pixels_.size(); }

  T* data() { return pixels_.data(); }
  const T* data() const { return pixels_.data(); }
  T* row(int y) { return pixels_.data() + static_cast<std::size_t>(y) * width_; }
  const T* row(int y) const { return pixels_.data() + static_cast<std::size_t>(y) * width_; }
  T& operator()(int x, int y) { return row(y)[x]; }
  const T& operator()(int x, int y) const { return row(y)[x]; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
  void fill(T value) { pixels_.assign(pixels_.size(), value); }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<T> pixels_;
};

/// 8-bit colour, red first (OpenCV's order is turned at the reader).
struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

using ColorImage = Image<Rgb8>;
/// Depth along the optical axis in metres; 0 = no measurement. Never NaN or negative.
using DepthImage = Image<float>;
using GrayImage = Image<std::uint8_t>;
/// 1 where something holds, else 0.
using PixelMask = Image<std::uint8_t>;

/// A colour or an opacity in 0..1 as a byte; what lies outside is clamped, NaN is 0.
inline std::uint8_t to_byte(float value) {
  return value > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.0f))) : 0;
}

/// Luma of one pixel, 0..255 (ITU-R BT.601 weights).
inline float luma(const Rgb8& c) {
  return 0.299f * static_cast<float>(c.r) + 0.587f * static_cast<float>(c.g) +
         0.114f * static_cast<float>(c.b);
}

}  // namespace sgs
