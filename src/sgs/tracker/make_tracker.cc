// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/cvm_tracker.h"
#include "sgs/tracker/gicp_tracker.h"
#include "sgs/tracker/given_tracker.h"
#include "sgs/tracker/orb_tracker.h"
#include "sgs/tracker/paper_tracker.h"
#include "sgs/tracker/render_tracker.h"
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
  SGS_RETURN_IF_ERROR(check(config));
  switch (config.type) {
    case TrackerType::kSpectral:
      return std::make_unique<SpectralTracker>(SpectralConfig(config), camera, T_world_first);
    case TrackerType::kPaper:
      return std::make_unique<PaperTracker>(PaperConfig(config), camera, T_world_first);
    case TrackerType::kGicp:
      return std::make_unique<GicpTracker>(GicpConfig(config), camera, T_world_first);
    case TrackerType::kOrb:
      return std::make_unique<OrbTracker>(OrbTrackerConfig(config), T_world_first);
    case TrackerType::kCvm:
      return std::make_unique<CvmTracker>(config.motion, T_world_first);
    case TrackerType::kGiven:
      return std::make_unique<GivenTracker>(config.given);
    case TrackerType::kRender:
      return std::make_unique<RenderTracker>(RenderTrackerConfig(config), camera, T_world_first);
  }
  return fail(ErrorCode::kInvalidArgument, "the tracker's type is none of those there are");
}

}  // namespace sgs::tracker
