// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "sgs/alignment/lost_reason.h"
#include "sgs/core/enum_names.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::tracker {

using sgs::to_string;  // so that tracker::to_string(status) finds the words of the enums below

/// How far a pose can be trusted. Expected bad luck is a value, not an error.
enum class TrackingStatus {
  kOk,          ///< all six directions observed
  kDegenerate,  ///< tracked, but some direction is not observed by geometry
  kLost,        ///< no trustworthy pose: nothing may be inserted
};
constexpr auto enum_names(TrackingStatus) {
  using enum TrackingStatus;
  return std::to_array<EnumName<TrackingStatus>>(
      {{kOk, "ok"}, {kDegenerate, "degenerate"}, {kLost, "lost"}});
}

/// What knew about the pose beside the registration of depth.
enum class PriorSource {
  kNone,
  kZero,              ///< "the pose has not changed", for want of a better prior
  kConstantVelocity,  ///< the last motion, repeated
  kOrb,               ///< features
  kPhotometric,       ///< the keyframes' pictures
};
constexpr auto enum_names(PriorSource) {
  using enum PriorSource;
  return std::to_array<EnumName<PriorSource>>({{kNone, "none"},
                                               {kZero, "zero"},
                                               {kConstantVelocity, "cvm"},
                                               {kOrb, "orb"},
                                               {kPhotometric, "photometric"}});
}

/// Everything that frames.csv says about one frame's tracking (docs/method.md, section 8). Trackers
/// only write it; nothing that they decide is read from here. NaN = not computed by this tracker.
struct Diagnostics {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 6> eigenvalues = {kNone, kNone, kNone, kNone, kNone, kNone};  ///< of H, rising
  std::array<double, 6> snr = {kNone, kNone, kNone, kNone, kNone, kNone};  ///< per axis, as weights
  std::array<double, 6> weights = {0, 0, 0, 0, 0, 0};  ///< w_k: 0 seen .. 1 unseen by geometry
  /// Columns: the unit camera twists (rotation first) that weights and snr speak of; empty where
  /// the tracker does not ask.
  std::optional<Matrix6d> axes;
  unsigned degenerate_mask = 0;     ///< bit k set where w_k > 0.5
  double condition_number = kNone;  ///< lambda_max / lambda_min of the registration Hessian
  double planarity = kNone;         ///< eta of the Gaussians' normals, 0..1
  PriorSource prior_source = PriorSource::kNone;
  bool prior_active = false;
  int targets = 0;             ///< points of the map that the search looks through
  int source_points = 0;       ///< sampled points of the frame
  int inliers = 0;             ///< matched ones at the final pose
  int visual_inliers = 0;      ///< photometric pixels or features used
  double overlap = kNone;      ///< share of source points explained by the map
  double movers = kNone;       ///< share of source points that move
  double cost = kNone;         ///< joint cost at the final pose
  double visual_cost = kNone;  ///< mean photometric cost per pixel (1 = as its noise model expects)
  double depth_delay_s = kNone;  ///< of depth after its stamp, as learned so far
  double readout_s = kNone;      ///< readout time of the rolling shutter, as learned so far
  int iterations = 0;  ///< Gauss-Newton steps over all levels of the alignment that counts
  /// CPU time per step, of everything that was tried.
  double ms_points = 0, ms_index = 0, ms_geometry = 0, ms_visual = 0, ms_update = 0;
};

/// Outcome of tracking one frame.
struct TrackResult {
  /// The pose that was found; of a lost frame the last one, or that carried on for a moment at
  /// constant velocity (`spectral`).
  SE3 T_odom_camera;
  TrackingStatus status = TrackingStatus::kOk;
  alignment::LostReason lost_reason =
      alignment::LostReason::kNone;  ///< anything else exactly where status is kLost
  bool keyframe = false;             ///< the tracker extended its own target map with this frame
  /// What the alignment saw of the pose: its normal equations, on twists of the camera. Pixels and
  /// points are counted as if they were independent. Empty where the tracker does not know.
  std::optional<Matrix6d> information;
  /// How the camera moved while the frame was measured; zero where not known.
  registration::FrameMotion motion;
  /// Pixels that show nothing that moves by itself: all that may be learned from or remembered, by
  /// whomever; null: all of them.
  std::shared_ptr<const PixelMask> still;
  Diagnostics diagnostics;
};

}  // namespace sgs::tracker
