// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/targets/target_map.h"

namespace sgs::alignment {

/// Gaussians of the newest snapshot as targets: their optimised means and shortest axes, or the
/// points and normals they were born with. Until the first snapshot arrives, own points.
///
/// Gaussians carry no number, but what one was born with never changes; snapshots list the
/// survivors in the old order and new ones behind. So old and new lists are merged by anchor:
/// survivors keep their index, pruned ones are marked as removed, and the search re-indexes only
/// what changed. A snapshot in another order is taken over as a whole.
class SnapshotTargets : public TargetMap {
 public:
  /// `config.target.source` tells which of the two: kOptimised or kAnchor.
  SnapshotTargets(const GeometryConfig& config, const SE3& T_local_world,
                  const TrackablePoints::Spacing& spacing);

  /// The Gaussians come revised with the next snapshot.
  void update(const LocalPast& past, const map::SnapshotPtr& snapshot) override;
  void insert(const registration::SourceCloud& source, const Observer& keyframe,
              const registration::CorrespondenceSearch* search) override;
  void remove_in(const registration::FreeSpace& space, const SE3& T_local_camera,
                 float new_margin_m) override {
    before_.remove_in(space, T_local_camera, new_margin_m);
  }
  const registration::TargetCloud& cloud() const override;
  bool wants_keyframes() const override { return !has_snapshot_; }
  bool follows_map() const override { return true; }

 private:
  void append(const map::Anchor& anchor);
  void set_target(std::size_t target, const map::Gaussian& gaussian, const map::Anchor& anchor);
  bool assign_targets(const map::Snapshot& snapshot);

  bool at_anchors_;
  float min_opacity_logit_;
  float covariance_floor_;
  float scale_sigmas_;
  bool with_ellipses_;
  Eigen::Matrix3f R_local_world_;
  Eigen::Vector3f t_local_world_;
  std::uint64_t version_ = 0;
  bool has_snapshot_ = false;
  std::vector<std::size_t> target_of_;  // per Gaussian of the snapshot
  std::vector<map::Anchor> anchors_;    // per target, as in the snapshot
  registration::TargetCloud cloud_;
  TrackablePoints before_;  // the map of the frames before the first snapshot
};

}  // namespace sgs::alignment
