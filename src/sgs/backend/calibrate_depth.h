// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/backend/bundle.h"
#include "sgs/geometry/pose_correction.h"

namespace sgs::backend {

/// What a batch of keyframes says about the depth camera.
struct DepthEstimate {
  /// What is known well enough to be used; the rest is as the camera came: no offset, no shift, no
  /// delay.
  DepthCalibration calibration;
  bool mean_known = false, shape_known = false, shift_known = false, delay_known = false;
  double shape_rms_per_m = 0, shape_sigma_per_m = 0;  ///< of the offsets about their mean
  int keyframes = 0;
  int grey_residuals = 0, depth_residuals = 0;
  BundleNoise noise;
  std::vector<MovedPose> poses;  ///< of the keyframes that were adjusted, before and after
  std::string why_not;           ///< why there is no estimate at all; empty where there is

  /// Whether there is anything to correct.
  bool useful() const { return mean_known || shape_known || shift_known || delay_known; }
  /// What a user should know about the recording; empty where all is well.
  std::vector<std::string> warnings() const;
};

/// Bundle adjustment of up to config.keyframes keyframes with the depth camera's offset, shift and
/// delay among the unknowns. What the first solution does not show to differ from nothing (at three
/// standard deviations) is held near nothing in a second one: a camera that is right stays as it
/// is. `readout_s`: readout time of the rolling shutter; `known`: an earlier estimate of the same
/// camera to start from.
DepthEstimate calibrate_depth(const std::vector<Keyframe>& keyframes, double readout_s,
                              const CalibrationConfig& config,
                              const DepthEstimate* known = nullptr);

}  // namespace sgs::backend
