// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "sgs/backend/backend_config.h"
#include "sgs/backend/keyframe.h"

namespace sgs::backend {

/// What the back end keeps of a frame; no pixels where it shows no depth.
Keyframe make_keyframe(const RgbdFrame& frame, const Vector6d& velocity,
                       const ArchiveConfig& config);

/// Chooses the keyframes of a tracked recording by how far the view has moved, and keeps them.
class KeyframeArchive {
 public:
  explicit KeyframeArchive(const ArchiveConfig& config) : config_(config) {}

  /// Takes in the next tracked frame, raw depth and all; `path` ends with it and has all before it.
  /// A frame becomes a keyframe once the next one tells how the camera moved.
  void add(const std::shared_ptr<const RgbdFrame>& frame, const history::Path& path);
  /// Tracking was lost here: the frames on either side do not tell how the camera moved.
  void note_gap();

  const std::vector<Keyframe>& keyframes() const { return keyframes_; }

 private:
  bool wants(const RgbdFrame& frame, const history::Path& path) const;

  ArchiveConfig config_;
  std::shared_ptr<const RgbdFrame> before_, pending_;  // the last frames; null: there was a gap
  std::vector<Keyframe> keyframes_;
};

}  // namespace sgs::backend
