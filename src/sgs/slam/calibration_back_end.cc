// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/calibration_back_end.h"

#include <cmath>
#include <utility>

#include "sgs/core/log.h"

namespace sgs::slam {

std::optional<history::Update> CalibrationBackEnd::add(
    const std::shared_ptr<const RgbdFrame>& frame, const tracker::TrackResult& result,
    const history::Revision& revision) {
  if (std::isfinite(result.diagnostics.readout_s)) readout_s_ = result.diagnostics.readout_s;
  // `frame` is as measured: beyond its stamp there is what was calibrated and what the tracker
  // adds.
  const double delay_s = result.motion.depth_delay_s - frame->depth_delay_s;
  if (result.status == tracker::TrackingStatus::kLost || !result.information) {
    calibration_.note_gap();
    return std::nullopt;
  }
  return told(calibration_.add(frame, revision, readout_s_, delay_s));
}

std::optional<history::Update> CalibrationBackEnd::told(
    std::optional<backend::LearnedCalibration> learned) {
  if (!learned) return std::nullopt;
  const DepthCalibration& c = learned->estimate.calibration;
  log().info(
      "the depth camera was calibrated from {} keyframes: offset {:+.5f} /m in the mean "
      "(sigma {:.5f}), {:.5f} /m about it, depth {:+.2f} {:+.2f} px off colour "
      "(sigma {:.2f} {:.2f}) and {:+.1f} ms after it (sigma {:.1f}); "
      "left over: {:.1f} grey, {:.1f} of the depth noise",
      learned->estimate.keyframes, c.mean_offset_per_m(), c.mean_sigma_per_m,
      learned->estimate.shape_rms_per_m, c.shift_px.x(), c.shift_px.y(), c.shift_sigma_px.x(),
      c.shift_sigma_px.y(), 1e3 * c.delay_s, 1e3 * c.delay_sigma_s, learned->estimate.noise.grey,
      learned->estimate.noise.depth);
  return std::move(learned->update);
}

}  // namespace sgs::slam
