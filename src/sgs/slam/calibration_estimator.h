// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/backend/online_calibration.h"
#include "sgs/slam/past_estimator.h"
#include "sgs/slam/session_config.h"

namespace sgs::slam {

/// Calibrates the depth camera. Frames come with their depth as measured.
class CalibrationEstimator final : public PastEstimator {
 public:
  explicit CalibrationEstimator(const SessionConfig& config) : calibration_(config.backend) {}

  std::shared_ptr<const PastCorrection> add(const std::shared_ptr<const RgbdFrame>& frame,
                                            const tracker::TrackResult& result) override;
  std::shared_ptr<const PastCorrection> finish() override { return told(calibration_.finish()); }
  void note_applied(const PastCorrection& correction) override {
    calibration_.note_applied(correction);
  }
  /// Calibrations learned.
  int found() const override { return calibration_.versions(); }

 private:
  static std::shared_ptr<const PastCorrection> told(
      std::optional<backend::LearnedCalibration> learned);

  backend::OnlineCalibration calibration_;
  double readout_s_ = 0;
};

}  // namespace sgs::slam
