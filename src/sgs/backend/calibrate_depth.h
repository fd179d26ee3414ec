// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sgs/backend/agreement.h"
#include "sgs/backend/bundle_setup.h"
#include "sgs/geometry/pose_correction.h"

namespace sgs::backend {

/// What a batch of keyframes says about the depth camera.
struct DepthEstimate {
  /// What is known well enough to be used; the rest is as the camera came: no offset, no shift, no
  /// delay.
  DepthCalibration calibration;
  CalibrationParts known;
  FreeEstimate free;                                  ///< before anything was held near nothing
  double shape_rms_per_m = 0, shape_sigma_per_m = 0;  ///< of the offsets about their mean
  int keyframes = 0;
  int grey_residuals = 0, depth_residuals = 0;
  BundleNoise noise;
  std::vector<MovedPose> poses;  ///< of the keyframes that were adjusted, before and after
  bool stamped = false;          ///< depth has time stamps of its own, beside those of colour
  /// By how much later than stamped the tracker takes depth for measured, where it learns that.
  std::optional<double> tracked_delay_s;
  std::string why_not;  ///< why there is no estimate at all; empty where there is
  /// What was found, but the recording contradicts itself about it: not used.
  CalibrationParts contradicted;
  std::string refused;  ///< why nothing that was found is to be used; empty where it may be

  /// Whether there is anything to correct.
  bool useful() const { return known.any() && refused.empty(); }
  /// Whether depth is later than a camera's may be: by more than a frame; or by more than 15 ms
  /// where both images have the same stamps, and the tracker does not see it too, to 5 ms.
  bool is_delay_suspicious() const;
  /// What a user should know about the recording; empty where all is well.
  std::vector<std::string> warnings() const;
};

/// Bundle adjustment of up to config.keyframes keyframes with the depth camera's offset, shift and
/// delay among the unknowns. What the first solution does not show to differ from nothing (at three
/// standard deviations) is held near nothing in a second one: a camera that is right stays as it
/// is. `readout_s`: readout time of the rolling shutter; `held`: parts that are held at nothing
/// from the beginning; `known`: an earlier estimate of the same camera to start from; `fewest`:
/// keyframes below which nothing is said.
DepthEstimate calibrate_depth(const KeyframeList& keyframes, double readout_s,
                              const CalibrationConfig& config, const CalibrationParts& held = {},
                              const DepthEstimate* known = nullptr, int fewest = 8);
/// The same from those that are of use, where the path has them.
DepthEstimate calibrate_depth(const std::vector<Keyframe>& keyframes, const history::Path& path,
                              double readout_s, const CalibrationConfig& config,
                              const DepthEstimate* known = nullptr);

}  // namespace sgs::backend
