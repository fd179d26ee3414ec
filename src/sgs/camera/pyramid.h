// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"

namespace sgs {

/// Grey value and its gradient at one pixel. Interleaved and padded to 16 bytes so that one
/// bilinear lookup touches four vectors in two cache lines.
struct GraySample {
  float intensity = 0;    ///< grey, 0..255
  float gx = 0;           ///< dI/du, grey per pixel of this level (central difference)
  float gy = 0;           ///< dI/dv
  float always_zero = 0;  ///< padding
};

/// Grey image at decreasing resolution with gradients, each level the 2x2 means of the one above
/// (odd edges dropped, as PinholeCamera::halved). Gradients are 0 on the outermost pixels.
/// Buffers are reused by build(): keep one object per stream. Reading is thread-safe.
class GrayPyramid {
 public:
  struct Level {
    PinholeCamera camera;
    Image<float> gray;          ///< 0..255
    Image<GraySample> samples;  ///< same size as `gray`

    /// Bilinear value and gradient at (u, v), 0 <= u < width - 1, 0 <= v < height - 1 (unchecked).
    GraySample interpolate(float u, float v) const;
  };

  /// Rebuilds all levels from the luma of `color`, whose size must be the camera's. Levels that
  /// would be smaller than 8 pixels on a side are left out.
  void build(const ColorImage& color, const PinholeCamera& camera, int levels);
  /// The same from grey values, 0..255.
  void build(const Image<float>& gray, const PinholeCamera& camera, int levels);

  int levels() const { return static_cast<int>(levels_.size()); }
  bool empty() const { return levels_.empty(); }
  const Level& level(int index) const { return levels_[static_cast<std::size_t>(index)]; }

 private:
  void prepare(const PinholeCamera& camera, int levels);
  void build_coarse_levels();
  std::vector<Level> levels_;
};

inline GraySample GrayPyramid::Level::interpolate(float u, float v) const {
  const int iu = static_cast<int>(u), iv = static_cast<int>(v);
  const float du = u - static_cast<float>(iu), dv = v - static_cast<float>(iv);
  const float w11 = du * dv, w10 = du - w11, w01 = dv - w11, w00 = 1 - du - w01;
  const GraySample* a = samples.row(iv) + iu;
  const GraySample* b = a + samples.width();
  return {w00 * a[0].intensity + w10 * a[1].intensity + w01 * b[0].intensity + w11 * b[1].intensity,
          w00 * a[0].gx + w10 * a[1].gx + w01 * b[0].gx + w11 * b[1].gx,
          w00 * a[0].gy + w10 * a[1].gy + w01 * b[0].gy + w11 * b[1].gy, 0.0f};
}

}  // namespace sgs
