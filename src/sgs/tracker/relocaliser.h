// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/camera/compact_view.h"
#include "sgs/camera/past_correction.h"
#include "sgs/features/ferns.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Finds the camera again after it was lost: among all visual keyframes those that look most alike
/// (features::Ferns), and of these ORB features matched without a prediction. Keyframes are kept at
/// about 320 pixels of width; features are extracted only when they are needed, so that a run that
/// is never lost never pays for them.
class Relocaliser {
 public:
  explicit Relocaliser(const RelocaliserConfig& config) : config_(config) {}

  /// Remembers a keyframe (what is needed of it is copied); the oldest makes room.
  void add_keyframe(const RgbdFrame& frame, const SE3& T_local_camera);
  /// Moves the remembered keyframes (in local coordinates).
  void correct(const PastCorrection& correction);
  /// Pose of a frame among the remembered keyframes, camera to local; empty when none fits.
  std::optional<SE3> relocalise(const RgbdFrame& frame);

 private:
  struct Keyframe {
    CompactView view;
    double timestamp_s;
    features::FernCode ferns;
    SE3 T_local_camera;
    std::vector<std::shared_ptr<const DepthChange>> changes;  // of its depth, not yet made
  };
  std::vector<std::size_t> most_alike(const RgbdFrame& frame) const;

  RelocaliserConfig config_;
  features::Ferns ferns_{0};
  std::deque<Keyframe> keyframes_;
};

}  // namespace sgs::tracker
