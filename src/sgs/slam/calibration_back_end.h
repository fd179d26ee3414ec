// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/backend/online_calibration.h"
#include "sgs/slam/back_end.h"
#include "sgs/slam/session_config.h"

namespace sgs::slam {

/// Calibrates the depth camera. Frames come with their depth as measured.
class CalibrationBackEnd final : public BackEnd {
 public:
  explicit CalibrationBackEnd(const SessionConfig& config) : calibration_(config.backend) {}

  std::optional<history::Update> add(const std::shared_ptr<const RgbdFrame>& frame,
                                     const tracker::TrackResult& result,
                                     const history::Revision& revision) override;
  std::optional<history::Update> finish(const history::Revision& revision) override {
    return told(calibration_.finish(revision));
  }
  /// Calibrations learned.
  int found() const override { return calibration_.versions(); }

 private:
  static std::optional<history::Update> told(std::optional<backend::LearnedCalibration> learned);

  backend::OnlineCalibration calibration_;
  double readout_s_ = 0;
};

}  // namespace sgs::slam
