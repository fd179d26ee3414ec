// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/held_out_fit.h"

#include <algorithm>

#include "sgs/backend/descent.h"

namespace sgs::backend {

std::optional<Fit> fit_with(const DepthCalibration& calibration, const KeyframeList& keyframes,
                            double readout_s, const CalibrationConfig& config,
                            const BundleNoise& noise) {
  Bundle bundle = make_bundle(keyframes, readout_s, config, &calibration);
  bundle.hold(calibration);
  BundleNoise following = noise;
  if (!descend(bundle, 1, 2, following) || !descend(bundle, 0, 5, following)) return {};
  const BundleEquations end = bundle.linearize(0, noise);
  Fit fit;
  fit.grey_residuals = end.grey_residuals;
  fit.depth_residuals = end.depth_residuals;
  fit.grey = end.grey_cost / std::max(1, end.grey_residuals);
  fit.depth = end.depth_cost / std::max(1, end.depth_residuals);
  return fit;
}

}  // namespace sgs::backend
