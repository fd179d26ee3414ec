// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/camera/compact_view.h"
#include "sgs/features/ferns.h"
#include "sgs/tracker/local_past.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Finds the camera again after it was lost: among all visual keyframes those that look most alike
/// (features::Ferns), and of these ORB features matched without a prediction. Keyframes are kept at
/// about 320 pixels of width; features are extracted only when they are needed, so that a run that
/// is never lost never pays for them.
class Relocaliser {
 public:
  explicit Relocaliser(const RelocaliserConfig& config) : config_(config) {}

  /// Remembers a keyframe (what is needed of it is copied), its depth corrected by `calibration`;
  /// the oldest makes room.
  void add_keyframe(const RgbdFrame& frame, const history::CalibrationPtr& calibration);
  /// Pose of a frame among the remembered keyframes, camera to local; empty when none fits. `past`
  /// tells where those are.
  std::optional<SE3> relocalise(const RgbdFrame& frame, const LocalPast& past);

 private:
  struct Keyframe {
    std::int64_t frame;  // its index
    CompactView view;
    history::CalibrationPtr calibration;  // of its depth
    features::FernCode ferns;
  };
  std::vector<std::size_t> most_alike(const RgbdFrame& frame) const;

  RelocaliserConfig config_;
  features::Ferns ferns_{0};
  std::deque<Keyframe> keyframes_;
};

}  // namespace sgs::tracker
