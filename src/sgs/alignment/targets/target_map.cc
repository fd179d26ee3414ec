// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/targets/target_map.h"

#include "sgs/alignment/targets/snapshot_targets.h"

namespace sgs::alignment {
namespace {

// Own points: nothing comes from the Gaussians.
class GridTargets : public TargetMap {
 public:
  explicit GridTargets(const TrackablePoints::Spacing& spacing) : points_(spacing) {}
  void update(const LocalPast& past, const map::SnapshotPtr&) override { points_.follow(past); }
  void insert(const registration::SourceCloud& source, const Observer& keyframe,
              const registration::CorrespondenceSearch* search) override {
    points_.insert(source, keyframe, search);
  }
  void remove_in(const registration::FreeSpace& space, const SE3& T_local_camera,
                 float new_margin_m) override {
    points_.remove_in(space, T_local_camera, new_margin_m);
  }
  const registration::TargetCloud& cloud() const override { return points_.cloud(); }
  bool wants_keyframes() const override { return true; }
  bool follows_map() const override { return false; }

 private:
  TrackablePoints points_;
};

}  // namespace

std::unique_ptr<TargetMap> make_target_map(const GeometryConfig& config, const SE3& T_local_world,
                                           double focal_px) {
  const TrackablePoints::Spacing spacing{
      static_cast<float>(config.target.spacing * config.target.step_px / focal_px),
      static_cast<float>(config.keyframe.overlap_distance_m)};
  if (config.target.source == TargetSource::kGrid) return std::make_unique<GridTargets>(spacing);
  return std::make_unique<SnapshotTargets>(config, T_local_world, spacing);
}

}  // namespace sgs::alignment
