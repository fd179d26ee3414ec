// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sgs::synthetic {

/// Reflectance or light per channel, 0..1, red first.
using Rgb = Eigen::Array3f;

/// A picture lying on a surface, `texel_m` metres per texel, that painters draw on. Coordinates of
/// all drawing functions are texels (texel centres at integers). 8 bits per channel.
class Canvas {
 public:
  struct Texel {
    std::uint8_t c[4];
  };
  Canvas() = default;
  Canvas(int width, int height, float texel_m);

  int width() const { return width_; }
  int height() const { return height_; }
  float texel_m() const { return texel_m_; }
  /// Texels per metre.
  float scale() const { return 1 / texel_m_; }
  const Texel* row(int y) const {
    return texels_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }
  Texel* row(int y) {
    return texels_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }
  Rgb get(int x, int y) const {
    const Texel& t = row(y)[x];
    return Rgb(t.c[0], t.c[1], t.c[2]) * (1.f / 255);
  }
  void set(int x, int y, const Rgb& color) {
    Texel& t = row(y)[x];
    for (int k = 0; k < 3; ++k)
      t.c[k] = static_cast<std::uint8_t>(std::clamp(color[k], 0.f, 1.f) * 255 + 0.5f);
  }
  void blend(int x, int y, const Rgb& color, float alpha) {
    if (alpha > 0) set(x, y, get(x, y) + alpha * (color - get(x, y)));
  }

  void fill(const Rgb& color);
  /// Straight line of the given width with round ends.
  void stroke(const Eigen::Vector2f& a, const Eigen::Vector2f& b, float width, const Rgb& color);
  /// Rotated ellipse with semi-axes `r`.
  void ellipse(const Eigen::Vector2f& centre, const Eigen::Vector2f& r, float angle,
               const Rgb& color, float alpha = 1);
  /// Convex polygon, corners in either direction.
  void polygon(const std::vector<Eigen::Vector2f>& corners, const Rgb& color, float alpha = 1);
  void rectangle(float x0, float y0, float x1, float y1, const Rgb& color, float alpha = 1);
  /// Copies `picture`, turned by `angle` about its centre, so that its centre comes to `centre`.
  /// Only rows [row_begin, row_end) are touched.
  void paste(const Canvas& picture, const Eigen::Vector2f& centre, float angle, int row_begin,
             int row_end);

 private:
  int width_ = 0, height_ = 0;
  float texel_m_ = 1;
  std::vector<Texel> texels_;
};

/// A canvas with its mip chain (2x2 means), ready for sampling.
class Texture {
 public:
  Texture() = default;
  explicit Texture(Canvas canvas);

  /// Colour at a position in metres from the corner of the first texel, blurred to a footprint of
  /// `footprint_m`: trilinear between the two nearest levels (Williams, Pyramidal Parametrics,
  /// SIGGRAPH 1983). Outside, the picture continues mirrored once, then clamped.
  Rgb sample(float x_m, float y_m, float footprint_m) const;
  float width_m() const { return width_m_; }
  float height_m() const { return height_m_; }

 private:
  std::vector<Canvas> levels_;
  float width_m_ = 0, height_m_ = 0;
};

}  // namespace sgs::synthetic
