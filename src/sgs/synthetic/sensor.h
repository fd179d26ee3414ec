// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/image.h"
#include "sgs/core/thread_pool.h"
#include "sgs/geometry/se3.h"
#include "sgs/synthetic/random.h"
#include "sgs/synthetic/ray_caster.h"

namespace sgs::synthetic {

/// What a sensor does to an ideal picture. Default: nothing.
struct SensorModel {
  bool noise = false;             ///< depth and colour noise, drop-outs, range limits, blur
  bool hard = false;              ///< the systematic errors on top
  double exposure_s = 0;          ///< of one row
  double rolling_shutter_s = 0;   ///< from the first to the last row
  double depth_delay_s = 0;       ///< of the depth image after the colour image
  double misregistration_px = 0;  ///< of depth against colour, constant over the sequence
  double lost_frames = 0;         ///< fraction
  float color_sigma = 0;          ///< 0..255
  float min_depth_m = 0, max_depth_m = 1e9f;
  float pattern = 0;           ///< fixed-pattern depth error in metres at 1 m, grows with z^2
  float distortion = 0;        ///< relative low-frequency depth error
  float factor = 0;            ///< relative depth error over the image, as large in all depths
  float growth_per_m2 = 0;     ///< relative depth error at 1 m that grows with z^2
  float disparity_per_m = 0;   ///< by how much inverse depths are too small everywhere
  float correlated_noise = 0;  ///< sigma of noise correlated over 8 px, in units of sigma_z
  float exposure_drift = 0;    ///< the gain stays within 1 -+ this

  /// "clean", "kinect", "hard" or "varied". How a sensor of the last kind errs is drawn from the
  /// seed: systematic errors of another form than those of "hard", some with the other sign.
  static SensorModel of_level(const std::string& level, std::uint64_t seed);
};

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
