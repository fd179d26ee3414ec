// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/synthetic/lens_rays.h"
#include "sgs/synthetic/ray_caster.h"
#include "sgs/synthetic/sensor_model.h"

namespace sgs::synthetic {

/// How a picture is exposed.
struct Exposure {
  double time_s = 0;                      ///< of a row
  float gain = 1;                         ///< from light to white = 1, the time included
  std::array<float, 3> balance{1, 1, 1};  ///< white balance: factors of red, green, blue
};

/// A colour camera as a chain of what spoils: motion during the exposure, optics, a mosaic of
/// colour filters with shot and read noise, interpolation, white balance, tone curve, 8 bits,
/// sharpening. Light is the square of a ray's colour, so that a tone curve that is a root gives the
/// colour back. Immutable; noise is a hash of (seed, frame, pixel).
class ColorCamera {
 public:
  ColorCamera(const ResponseModel& model, std::shared_ptr<const LensRays> lens, std::uint64_t seed);

  const LensRays& lens() const { return *lens_; }
  /// Grey value, 0..1, of exposed light; from 1 on it is white.
  float grey(float light) const;
  /// Mean grey values of red, green and blue over the picture, its middle counting twice, as
  /// automatic exposure sees them: sharp, without noise.
  std::array<double, 3> meter(const RayImage& view, const Exposure& exposure) const;
  /// The picture behind the lens. `half_motion` maps camera coordinates at mid-exposure to those at
  /// the end of it.
  ColorImage picture(const RayImage& view, const SE3& half_motion, const Exposure& exposure,
                     std::int64_t frame, ThreadPool& pool) const;

 private:
  using Light = std::vector<Eigen::Array4f>;
  float vignette(int x, int y) const;
  float filtered(const Eigen::Array4f& light, std::size_t channel) const;
  Light moved(const RayImage& view, const SE3& half_motion, ThreadPool& pool) const;
  void spread(Light& light, ThreadPool& pool) const;
  std::vector<float> mosaic(const Light& light, float gain, std::int64_t frame,
                            ThreadPool& pool) const;
  ColorImage developed(const std::vector<float>& raw, const Exposure& exposure,
                       ThreadPool& pool) const;
  ColorImage sharpened(const ColorImage& image, ThreadPool& pool) const;

  ResponseModel model_;
  std::shared_ptr<const LensRays> lens_;
  std::uint64_t seed_;
  int width_, height_;
  std::vector<float> curve_;  // grey over the root of light
};

}  // namespace sgs::synthetic
