// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/alignment/local_past.h"
#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/free_space.h"
#include "sgs/registration/rolling_shutter.h"
#include "sgs/registration/target_blocks.h"

namespace sgs::alignment {

/// A keyframe that saw target points.
struct Observer {
  std::int64_t frame = 0;  ///< its index
  SE3 T_local_camera;
  registration::FrameMotion motion;  ///< that its points are corrected for
};

/// Target points the tracker keeps itself: a sparse surfel map on the sampling grid. Each point
/// belongs to the keyframe that saw it and follows when that lies elsewhere or its depth is known
/// better. Points are never averaged: that gains nothing for tracking
/// (docs/method.md, section 7).
class TrackablePoints {
 public:
  struct Spacing {
    float radius_per_m = 0;  ///< least distance along the surface per metre of depth
    float distance_m = 0;    ///< and off it
  };

  // limit: points that the tracker keeps to register frames to
  static constexpr std::size_t kMostPoints = 3'000'000;

  explicit TrackablePoints(const Spacing& spacing, std::size_t most_points = kMostPoints)
      : spacing_(spacing), most_points_(most_points) {}

  /// Adds the points of a keyframe (camera to local) where no target is near, as `search`
  /// (prepared for this frame) tells; all of them when `search` is null. Returns how many were
  /// added. Where there are more than `most_points` then, a quarter of them goes: those of the
  /// keyframes that are farthest away. An hour of driving on would otherwise fill the memory.
  int insert(const registration::SourceCloud& source, const Observer& keyframe,
             const registration::CorrespondenceSearch* search);
  /// Removes the points that a camera at `T_local_camera` looks through by more than half of the
  /// spacing's distance, if they were seen a long way ago: what is nearer on the way contradicts
  /// the frame by what the depth camera errs, and holds the pose all the same; what is further
  /// differs by the drift since. What is newer goes where it is looked through by more than
  /// `new_margin_m`, which neither explains: it has moved away; 0: it stays. Returns how many there
  /// were.
  int remove_in(const registration::FreeSpace& space, const SE3& T_local_camera,
                float new_margin_m = 0);
  /// What is believed of the past now: comes before the first keyframe and with every frame, the
  /// keyframes so far in its path. Points move with the keyframes that saw them, and along their
  /// rays where depth is another.
  void follow(const LocalPast& past);

  /// Points that have not been removed.
  std::size_t alive() const { return alive_; }
  int keyframes() const { return static_cast<int>(keyframes_.size()); }
  const registration::TargetCloud& cloud() const { return cloud_; }

 private:
  struct Keyframe {
    std::int64_t frame;
    registration::FrameMotion motion;
    double path_m;           // of the keyframes before it
    std::size_t begin, end;  // of its points
  };

  void move(const Keyframe& keyframe, const SE3& T_now_before);
  void change_depth(Keyframe& keyframe, const SE3& T_local_camera, const DepthChange& change);
  void remove(std::size_t point);
  void remove_farthest(const Eigen::Vector3d& camera_position);
  void forget_removed();
  /// Length of the way from keyframe to keyframe until a camera at that pose.
  double path_to(const SE3& T_local_camera) const;

  Spacing spacing_;
  std::size_t most_points_;
  std::size_t alive_ = 0;
  LocalPast past_;
  std::vector<Keyframe> keyframes_;
  registration::TargetCloud cloud_;
  registration::TargetBlocks blocks_;
};

}  // namespace sgs::alignment
