// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/synthetic/color_camera.h"

namespace sgs::synthetic {

/// Automatic exposure and white balance. Exposure is held until the picture's mean luma is off by
/// more than is borne, then goes in steps until it is right; white balance follows the picture's
/// mean colour slowly and in part. Both act on the next picture. Not thread-safe.
class AutoExposure {
 public:
  AutoExposure(const ExposureModel& model, const ColorCamera& camera);

  /// Of the next picture.
  const Exposure& exposure() const { return exposure_; }
  /// As after a while of looking at `view`.
  void settle(const RayImage& view);
  /// Learns from a picture that was taken with exposure().
  void advance(const RayImage& view);

 private:
  void expose(double log_gain);
  void balance(const std::array<double, 3>& means, double rate);

  ExposureModel model_;
  const ColorCamera& camera_;
  Exposure exposure_;
  double log_gain_ = 0, usual_log_gain_ = 0;
  int since_step_ = 0;
  bool adjusting_ = false;
};

}  // namespace sgs::synthetic
