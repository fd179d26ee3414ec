// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/alignment/alignment_config.h"
#include "sgs/alignment/targets/trackable_points.h"
#include "sgs/map/gaussian.h"
#include "sgs/registration/correspondence_search.h"

namespace sgs::alignment {

/// The points frames are registered to (which ones: docs/method.md, section 7), in local
/// coordinates: those of the tracker's first camera.
class TargetMap {
 public:
  virtual ~TargetMap() = default;
  /// The tracker's own targets follow what is believed of the past; others take over the state of
  /// the Gaussian map, null before the first one exists.
  virtual void update(const LocalPast& past, const map::SnapshotPtr& snapshot) = 0;
  /// Extends the targets by a tracking keyframe, if they are the tracker's own. `search` is
  /// prepared for this frame, or null for the first one.
  virtual void insert(const registration::SourceCloud& source, const Observer& keyframe,
                      const registration::CorrespondenceSearch* search) = 0;
  /// Removes those of the tracker's own targets that a camera at `T_local_camera` looks through
  /// (TrackablePoints::remove_in).
  virtual void remove_in(const registration::FreeSpace& space, const SE3& T_local_camera,
                         float new_margin_m) = 0;
  /// Whether insert() does anything now.
  virtual bool wants_keyframes() const = 0;
  virtual const registration::TargetCloud& cloud() const = 0;
  /// Whether the targets move with the Gaussians.
  virtual bool follows_map() const = 0;
};

/// The target map that `config.target.source` names. `T_local_world` takes snapshots into local
/// coordinates; `focal_px` relates the sampling step to metres.
std::unique_ptr<TargetMap> make_target_map(const GeometryConfig& config, const SE3& T_local_world,
                                           double focal_px);

}  // namespace sgs::alignment
