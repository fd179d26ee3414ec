// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"

namespace sgs {

/// Grey value and its gradient at one place of a level.
struct GraySample {
  float intensity = 0;  ///< grey, 0..255
  float gx = 0;         ///< dI/du, grey per pixel of this level (central difference)
  float gy = 0;         ///< dI/dv
};

/// Grey image at decreasing resolution, each level the 2x2 means of the one above (odd edges
/// dropped, as PinholeCamera::halved). Gradients are not kept: a lookup reads at most twelve grey
/// values, and images that stay in the cache are worth more than the arithmetic saved.
/// Pixels that the camera did not see are NaN, and so is each lookup that touches one; a coarser
/// pixel is the mean of those of its four that were seen, NaN where fewer than two were.
/// Buffers are reused by build(): keep one object per stream. Reading is thread-safe.
class GrayPyramid {
 public:
  struct Level {
    PinholeCamera camera;
    Image<float> gray;  ///< 0..255

    /// Bilinear value and gradient at (u, v), 1 <= u < width - 2, 1 <= v < height - 2 (unchecked).
    GraySample interpolate(float u, float v) const;
  };

  /// Rebuilds all levels from the luma of `color`, whose size must be the camera's. Levels that
  /// would be smaller than 8 pixels on a side are left out.
  /// `seen`: as RgbdFrame::seen, null for all.
  void build(const ColorImage& color, const PinholeCamera& camera, int levels,
             const PixelMask* seen = nullptr);
  /// The same from grey values, 0..255.
  void build(const Image<float>& gray, const PinholeCamera& camera, int levels);

  int levels() const { return static_cast<int>(levels_.size()); }
  bool empty() const { return levels_.empty(); }
  const Level& level(int index) const { return levels_[static_cast<std::size_t>(index)]; }

 private:
  void prepare(const PinholeCamera& camera, int levels);
  void build_coarse_levels(bool all_seen);
  std::vector<Level> levels_;
};

inline GraySample GrayPyramid::Level::interpolate(float u, float v) const {
  const int iu = static_cast<int>(u), iv = static_cast<int>(v);
  const float du = u - static_cast<float>(iu), dv = v - static_cast<float>(iv);
  const float w11 = du * dv, w10 = du - w11, w01 = dv - w11, w00 = 1 - du - w01;
  const std::ptrdiff_t stride = gray.width();
  const float* b = gray.row(iv) + iu;  // the four pixels are b[0], b[1], c[0], c[1]
  const float *a = b - stride, *c = b + stride, *d = c + stride;
  const auto blend = [&](float v00, float v10, float v01, float v11) {
    return w00 * v00 + w10 * v10 + w01 * v01 + w11 * v11;
  };
  return {blend(b[0], b[1], c[0], c[1]),
          0.5f * blend(b[1] - b[-1], b[2] - b[0], c[1] - c[-1], c[2] - c[0]),
          0.5f * blend(c[0] - a[0], c[1] - a[1], d[0] - b[0], d[1] - b[1])};
}

}  // namespace sgs
