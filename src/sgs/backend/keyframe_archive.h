// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sgs/backend/backend_config.h"
#include "sgs/backend/keyframe.h"
#include "sgs/camera/past_correction.h"

namespace sgs::backend {

/// What the back end keeps of a frame; no pixels where it shows no depth.
Keyframe make_keyframe(const RgbdFrame& frame, const SE3& T_world_camera, const Vector6d& velocity,
                       const ArchiveConfig& config);

/// Chooses the keyframes of a tracked recording by how far the view has moved, and keeps them.
class KeyframeArchive {
 public:
  explicit KeyframeArchive(const ArchiveConfig& config) : config_(config) {}

  /// Takes in the next tracked frame, raw depth and all. A frame becomes a keyframe once the next
  /// one tells how the camera moved.
  void add(const std::shared_ptr<const RgbdFrame>& frame, const SE3& T_world_camera);
  /// Tracking was lost here: the frames on either side do not tell how the camera moved.
  void note_gap();
  /// Moves the keyframes; their depth stays as it was measured.
  void correct(const PastCorrection& correction);

  const std::vector<Keyframe>& keyframes() const { return keyframes_; }

 private:
  struct Tracked {
    std::shared_ptr<const RgbdFrame> frame;
    SE3 T_world_camera;
  };
  bool wants(const SE3& T_world_camera) const;

  ArchiveConfig config_;
  std::optional<Tracked> before_, pending_;
  std::vector<Keyframe> keyframes_;
};

}  // namespace sgs::backend
