// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/calibrate.h"

#include <cmath>

#include "sgs/backend/keyframe_archive.h"
#include "sgs/run/track_only.h"

namespace sgs::run {

Result<backend::DepthEstimate> calibrate(Input& input, const slam::SessionConfig& config,
                                         const std::function<void()>& progress,
                                         const std::stop_token& stop) {
  backend::KeyframeArchive archive(config.backend.archive);
  double readout_s = 0;
  const auto take_in = [&](const std::shared_ptr<const RgbdFrame>& frame,
                           const tracker::TrackResult* result) {
    if (result == nullptr || result->status == tracker::TrackingStatus::kLost) {
      archive.note_gap();
    } else {
      archive.add(frame, result->T_world_camera);
      const double learned_s = result->diagnostics.readout_s;
      if (std::isfinite(learned_s)) readout_s = learned_s;
    }
    if (progress) progress();
  };
  SGS_RETURN_IF_ERROR(track_only(*input.source, config, take_in, stop));
  return backend::calibrate_depth(archive.keyframes(), readout_s, config.backend.calibration);
}

}  // namespace sgs::run
