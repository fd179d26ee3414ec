// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/alignment/joint_aligner.h"
#include "sgs/render/rasterizer.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/pose_descent.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// Tracks against the picture of the map: the pose is the one from which the newest snapshot,
/// rendered, differs least from the frame (PoseDescent); a drawing from there says, by the rules of
/// `spectral`, which axes depth leaves open and whether the picture fills them: directions that
/// neither sees are reported, not slid along. With method `aligned` the snapshot is drawn from
/// where the camera probably is and the frame is aligned to that drawing by a JointAligner; drawn
/// again from there, and once more (projective alignment to a predicted view, as in Newcombe et
/// al., KinectFusion, 2011, with a Gaussian map as the model). Until there is a map the last frame
/// that was tracked takes its place.
class RenderTracker : public Tracker {
 public:
  RenderTracker(const RenderTrackerConfig& config, const PinholeCamera& camera,
                const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const history::Revision&,
                    const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return true; }
  double least_mapping_steps() const override { return config_.rendering.mapping_steps; }

 private:
  /// A picture with depth and where it was seen from: what a frame is aligned to.
  struct Reference {
    RgbdFrame frame;
    SE3 T_world_camera;
  };
  TrackResult begin(const RgbdFrame& frame);
  /// Draws the map as seen from a pose.
  void draw(const map::Snapshot& snapshot, const SE3& T_world_camera);
  /// By alignment to drawings, each from where the last one led to.
  alignment::Alignment align_to_drawings(const RgbdFrame& frame, const map::Snapshot& snapshot,
                                         const SE3& T_world_start);
  alignment::Alignment descend(const RgbdFrame& frame, const map::Snapshot& snapshot,
                               const SE3& T_world_start);
  enum class Move { kFree, kNot };
  /// Aligns a frame to the reference, or judges the start; the aligner is kept for what it tells
  /// about the frame.
  alignment::Alignment align(const RgbdFrame& frame, const SE3& T_world_start,
                             Move move = Move::kFree);
  TrackResult tracked(const alignment::Alignment& a) const;
  TrackResult lost(const alignment::Alignment& a);

  RenderTrackerConfig config_;
  PinholeCamera camera_;
  std::unique_ptr<render::Rasterizer> rasterizer_;
  render::Rendering rendering_;
  PoseDescent descent_;
  std::optional<Reference> reference_;
  std::optional<alignment::JointAligner> aligner_;  // of the last alignment
  MotionModel motion_;                              // camera to world
};

}  // namespace sgs::tracker
