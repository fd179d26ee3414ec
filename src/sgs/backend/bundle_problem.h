// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/backend/backend_config.h"
#include "sgs/backend/keyframe.h"
#include "sgs/camera/depth_calibration.h"

namespace sgs::backend {

/// I = exp(gain) * radiance + offset, one per keyframe.
struct Exposure {
  double log_gain = 0;
  double offset = 0;  ///< grey
};

/// What a bundle adjustment estimates.
struct BundleState {
  std::vector<SE3> T_world_camera;
  std::vector<Exposure> exposures;
  /// How much further than its mean rate tells each camera turns during its readout, rad.
  std::vector<Eigen::Vector3d> readout_turns;
  std::vector<std::vector<double>> inverse_depths;  ///< per keyframe and pixel, 1/m
  Eigen::VectorXd offsets_per_m;                    ///< of depth, per node of the grid
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  double delay_s = 0;  ///< of depth after colour
};

/// What is adjusted together: which pixels are looked for in which keyframes. The keyframes must
/// outlive it.
struct BundleProblem {
  std::vector<const Keyframe*> keyframes;
  std::vector<std::vector<int>> targets;  ///< per keyframe: where its pixels are looked for
  double readout_s = 0;                   ///< of the rolling shutter, first row to last
  ImageGrid grid;
  CalibrationConfig config;
  bool calibration_held = false;  ///< stays as the state begins with it; only the rest is adjusted
};

}  // namespace sgs::backend
