// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/backend/agreement.h"
#include "sgs/backend/bundle_setup.h"

namespace sgs::backend {

/// Adjusts everything but the calibration, which is held as given, and tells what is left over.
/// `noise`: of the residuals whose cost is told, the same for all that are compared. Empty where
/// the adjustment leads nowhere.
std::optional<Fit> fit_with(const DepthCalibration& calibration, const KeyframeList& keyframes,
                            double readout_s, const CalibrationConfig& config,
                            const BundleNoise& noise);

}  // namespace sgs::backend
