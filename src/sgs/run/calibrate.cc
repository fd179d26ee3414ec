// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/calibrate.h"

#include <cmath>

#include "sgs/backend/keyframe_archive.h"
#include "sgs/backend/sure_calibration.h"
#include "sgs/core/log.h"
#include "sgs/io/depth_calibration_io.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {

Result<backend::DepthEstimate> calibrate(Input& input, const slam::SessionConfig& config,
                                         const TrackedFrame& watch, const std::stop_token& stop) {
  backend::KeyframeArchive archive(config.backend.archive);
  history::Path path;
  double readout_s = 0, delay_s = 0;
  const auto take_in = [&](const std::shared_ptr<const RgbdFrame>& frame,
                           const tracker::TrackResult* result) {
    if (result == nullptr || result->status == tracker::TrackingStatus::kLost) {
      archive.note_gap();
    } else {
      path.append({frame->index, frame->timestamp_s, result->T_odom_camera});
      archive.add(frame, path);
      delay_s = result->motion.depth_delay_s - frame->depth_delay_s;
      const double learned_s = result->diagnostics.readout_s;
      if (std::isfinite(learned_s)) readout_s = learned_s;
    }
    if (watch) watch(frame, result);
  };
  SGS_RETURN_IF_ERROR(track_only(*input.source, config, take_in, stop));
  auto estimate =
      backend::calibrate_surely(archive.keyframes(), path, readout_s, config.backend.calibration);
  estimate.tracked_delay_s = delay_s;
  return estimate;
}

Status calibrate_first(InputSpec& spec, Input& input, const slam::SessionConfig& config,
                       int threads, RunFolder& folder, const TrackedFrame& watch,
                       const std::stop_token& stop) {
  SGS_ASSIGN_OR_RETURN(const auto estimate, calibrate(input, config, watch, stop));
  if (estimate.useful()) {
    const auto path = folder.path() / files::kCalibration;
    SGS_RETURN_IF_ERROR(io::save_depth_calibration(path, estimate.calibration));
    spec.calibration = path.string();
  } else if (!estimate.why_not.empty() || !estimate.refused.empty()) {
    log().warn("depth is used as it is: {}",
               estimate.refused.empty() ? estimate.why_not : estimate.refused);
  } else {
    log().info("depth is used as it is: nothing is wrong with it that the recording could tell");
  }
  for (const std::string& warning : estimate.warnings()) log().warn("{}", warning);
  SGS_ASSIGN_OR_RETURN(input, open_input(spec, threads));
  return {};
}

}  // namespace sgs::run
