// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sgs/api/export.h"
#include "sgs/api/types.h"

namespace sgs::api {

/// How far a pose can be trusted.
enum class TrackingStatus {
  kOk,          ///< all six directions observed by geometry
  kDegenerate,  ///< tracked, but some direction is not observed by geometry
  kLost,        ///< no pose that can be trusted
};

/// A direction that geometry does not see.
struct WeakDirection {
  std::array<double, 6> twist{};  ///< unit twist of the camera: rotation x y z, translation x y z
  double weight = 0;              ///< of vision along it: 0 seen by geometry .. 1 unseen
  double snr = 0;                 ///< information over what noise alone would show
};

/// What the registration saw of the six directions of a pose (docs/degeneracy.md). NaN = this
/// tracker does not compute it.
struct Spectrum {
  std::array<double, 6> eigenvalues{};  ///< of its Hessian, rising
  /// Row k: principal axis k as a unit twist of the camera, rotation first. snr and weights speak
  /// of these; zero where the tracker does not ask.
  std::array<std::array<double, 6>, 6> axes{};
  std::array<double, 6> snr{};
  std::array<double, 6> weights{};
};

/// What became of one frame: the values of frames.csv (docs/formats.md) that programs ask for.
struct SGS_API FrameResult {
  std::int64_t index = 0;  ///< of the frame: as fed, counted from 0, or of its recording
  double timestamp_s = 0;
  TrackingStatus status = TrackingStatus::kLost;
  std::string lost_reason;  ///< as in frames.csv; `none` where it is not lost
  /// Where the camera is. Of a lost frame the last pose, perhaps carried on for a moment.
  Pose T_world_camera = kIdentityPose;
  Spectrum spectrum;
  bool prior_active = false;        ///< vision or a prior filled directions that geometry left open
  bool mapping_keyframe = false;    ///< went into the map
  bool heldout = false;             ///< kept from the mapper, for evaluation
  std::int64_t inliers = 0;         ///< points matched to the map
  std::int64_t visual_inliers = 0;  ///< pixels or features that vision used
  double overlap = 0;               ///< share of the frame's points that the map explains
  std::int64_t gaussians = 0;       ///< of the map it was tracked against
  std::int64_t loops = 0;           ///< closed so far
  double correction_m = 0;          ///< by how much closing a loop moved the past before this frame
  double track_ms = 0;              ///< CPU time of tracking

  /// The directions whose weight exceeds `threshold`, heaviest first.
  std::vector<WeakDirection> weak_directions(double threshold = 0.5) const;
};

}  // namespace sgs::api
