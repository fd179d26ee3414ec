// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/cvm_tracker.h"
#include "sgs/tracker/gicp_tracker.h"
#include "sgs/tracker/spectral_tracker.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

Result<std::unique_ptr<Tracker>> make_tracker(const TrackerConfig& config,
                                              const PinholeCamera& camera,
                                              const SE3& T_world_first) {
  if (!camera.valid()) {
    return fail(ErrorCode::kInvalidArgument, "the tracker needs a camera with positive size",
                "check the sequence's calibration");
  }
  if (config.type == "gicp") return std::make_unique<GicpTracker>(config, camera, T_world_first);
  if (config.type == "spectral" && config.fusion != "prior") {
    return std::make_unique<SpectralTracker>(config, camera, T_world_first);
  }
  if (config.type == "cvm") return std::make_unique<CvmTracker>(config, T_world_first);
  if (config.type == "spectral" || config.type == "orb") {
    return fail(ErrorCode::kUnsupported,
                fmt::format("the tracker '{}' is not part of this version", config.type),
                "use --tracker gicp");
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown tracker '{}'", config.type),
              "use --tracker gicp or --tracker cvm");
}

}  // namespace sgs::tracker
