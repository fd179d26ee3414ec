// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/cvm_tracker.h"
#include "sgs/tracker/gicp_tracker.h"
#include "sgs/tracker/orb_tracker.h"
#include "sgs/tracker/prior_tracker.h"
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
  if (config.type == "orb") return std::make_unique<OrbTracker>(config, T_world_first);
  if (config.type == "spectral" && config.fusion == "prior") {
    return std::make_unique<PriorTracker>(config, camera, T_world_first);
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown tracker '{}'", config.type),
              "use --tracker spectral, gicp, orb or cvm");
}

}  // namespace sgs::tracker
