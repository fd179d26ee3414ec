// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/synthetic/random.h"
#include "sgs/synthetic/ray_caster.h"
#include "sgs/synthetic/sensor_model.h"

namespace sgs::synthetic {

/// Turns ray-cast images into what a sensor delivers. Immutable after construction; noise is a hash
/// of (seed, frame, pixel).
class Sensor {
 public:
  Sensor(const SensorModel& model, const PinholeCamera& camera, std::uint64_t seed);

  const SensorModel& model() const { return model_; }
  /// Pixels by which depth rays are shifted against colour rays.
  Eigen::Vector2d registration_shift() const;
  bool frame_lost(std::int64_t frame) const;
  /// By how much the inverse depths measured in row `y` of the depth image are too small for
  /// surfaces at `depth_m` (a row of depths, 0 = none), in the mean over the noise, 1/m.
  std::vector<float> inverse_depth_offsets(int y, const float* depth_m) const;
  /// Exposure gain at `t_s` seconds after the start.
  float gain(double t_s) const;

  DepthImage depth(const RayImage& exact, std::int64_t frame, ThreadPool& pool) const;
  /// `half_motion` maps camera coordinates at mid-exposure to those at the end of it.
  ColorImage color(const RayImage& exact, const SE3& half_motion, float gain, std::int64_t frame,
                   ThreadPool& pool) const;

 private:
  struct SystematicRow;
  SystematicRow systematic_row(int y) const;
  void depth_row(const RayImage& exact, int y, std::int64_t frame, const SmoothField* correlated,
                 float* out) const;
  SensorModel model_;
  PinholeCamera camera_;
  std::uint64_t seed_;
  std::optional<SmoothField> pattern_, distortion_, factor_;
  float factor_mean_ = 0;  // of the field: a common factor would be another world's size
};

}  // namespace sgs::synthetic
