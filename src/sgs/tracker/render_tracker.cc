// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/render_tracker.h"

#include "sgs/alignment/loss_checks.h"
#include "sgs/render/rendered_images.h"

namespace sgs::tracker {
namespace {

/// The map's drawing plays the part of the tracker's own last keyframe.
alignment::AlignerConfig to_drawing(alignment::AlignerConfig config) {
  config.geometry.target.source = alignment::TargetSource::kGrid;
  return config;
}

/// The map has no shutter of its own, and an unknown more would be one that a soft picture has to
/// tell.
alignment::ReadoutEstimator::Belief no_motion_during_readout() {
  constexpr double kCertain = 1e12;  // 1/rad^2
  return {Vector6d::Zero(), kCertain * Eigen::Matrix3d::Identity()};
}

}  // namespace

RenderTracker::RenderTracker(const RenderTrackerConfig& config, const PinholeCamera& camera,
                             const SE3& T_world_first)
    : config_(config),
      camera_(camera),
      rasterizer_(render::make_cpu_rasterizer(nullptr)),
      descent_(config.rendering, *rasterizer_),
      motion_(config.motion, T_world_first) {
  config_.aligner = to_drawing(config.aligner);
}

TrackResult RenderTracker::track(const RgbdFrame& frame, const history::Revision&,
                                 const map::SnapshotPtr& snapshot) {
  if (!reference_) return begin(frame);
  const bool has_map = snapshot && !snapshot->gaussians.empty();
  const SE3 T_start = motion_.predict(frame.timestamp_s);
  alignment::Alignment a = !has_map ? align(frame, T_start)
                           : config_.rendering.method == RenderMethod::kAligned
                               ? align_to_drawings(frame, *snapshot, T_start)
                               : descend(frame, *snapshot, T_start);
  if (a.trusted()) a.lost_reason = motion_.judge(a.T_local_camera);
  if (!a.trusted()) return lost(a);
  motion_.accept(a.T_local_camera, frame.timestamp_s);
  if (!has_map) reference_ = Reference{frame, a.T_local_camera};
  return tracked(a);
}

alignment::Alignment RenderTracker::align_to_drawings(const RgbdFrame& frame,
                                                      const map::Snapshot& snapshot,
                                                      const SE3& T_world_start) {
  alignment::Alignment a;
  SE3 T_start = T_world_start;
  for (int round = 0; round < config_.rendering.rounds; ++round) {
    draw(snapshot, T_start);
    a = align(frame, T_start);
    if (!a.trusted()) break;
    T_start = a.T_local_camera;
  }
  return a;
}

alignment::Alignment RenderTracker::descend(const RgbdFrame& frame, const map::Snapshot& snapshot,
                                            const SE3& T_world_start) {
  const auto descend_from = [&](const SE3& T_start) {
    const SE3 T = descent_.descend(snapshot.gaussians, frame, T_start);
    draw(snapshot, T);
    return align(frame, T, Move::kNot);
  };
  alignment::Alignment a = descend_from(T_world_start);
  if (a.trusted()) return a;
  // Coarse to fine it may still be found.
  const alignment::Alignment aligned = align_to_drawings(frame, snapshot, T_world_start);
  if (!aligned.trusted()) return a;
  a = descend_from(aligned.T_local_camera);
  return a.trusted() ? a : aligned;
}

// The first frame is where the tracker was told it is; all it needs is depth.
TrackResult RenderTracker::begin(const RgbdFrame& frame) {
  aligner_.emplace(config_.aligner, camera_, SE3{});
  aligner_->look_at(frame, {}, nullptr);
  alignment::Alignment a;
  a.T_local_camera = motion_.pose();
  a.lost_reason = aligner_->check_frame();
  if (!a.trusted()) return lost(a);
  reference_ = Reference{frame, a.T_local_camera};
  motion_.accept(a.T_local_camera, frame.timestamp_s);
  TrackResult result = tracked(a);
  result.keyframe = true;
  return result;
}

void RenderTracker::draw(const map::Snapshot& snapshot, const SE3& T_world_camera) {
  rasterizer_->render(snapshot.gaussians, camera_, T_world_camera, rendering_);
  RgbdFrame& drawing = reference_->frame;
  drawing.camera = camera_;
  drawing.color = render::to_color_image(rendering_.color);
  drawing.depth = render::mean_depth(rendering_, static_cast<float>(config_.rendering.min_alpha));
  reference_->T_world_camera = T_world_camera;
}

// The aligner's local frame is the camera that the reference was seen from; what comes back is in
// the world.
alignment::Alignment RenderTracker::align(const RgbdFrame& frame, const SE3& T_world_start,
                                          Move move) {
  const SE3& T_world_local = reference_->T_world_camera;
  aligner_.emplace(config_.aligner, camera_, SE3{});
  aligner_->look_at(reference_->frame, {}, nullptr);
  aligner_->extend(alignment::Alignment{}, Vector6d::Zero());
  history::Revision reference_alone;
  reference_alone.path.append({reference_->frame.index, reference_->frame.timestamp_s, SE3{}});
  aligner_->look_at(frame, reference_alone, nullptr);
  alignment::Alignment a;
  a.lost_reason = aligner_->check_frame();
  const bool something_to_see = aligner_->has_map();
  if (a.trusted() && !something_to_see) a.lost_reason = alignment::LostReason::kTooFewMatches;
  if (a.trusted()) {
    const alignment::ReadoutModel global_shutter = {
        [](const SE3&) { return no_motion_during_readout(); },
        [](const Vector6d&, const SE3&) { return registration::FrameMotion{}; }};
    const SE3 T_local_start = T_world_local.inverse() * T_world_start;
    a = move == Move::kFree ? aligner_->align(T_local_start, global_shutter)
                            : aligner_->measure(T_local_start, global_shutter);
  }
  a.T_local_camera = (T_world_local * a.T_local_camera).normalized();
  return a;
}

TrackResult RenderTracker::tracked(const alignment::Alignment& a) const {
  TrackResult result;
  result.T_odom_camera = a.T_local_camera;
  result.status =
      aligner_->observability().mask != 0 ? TrackingStatus::kDegenerate : TrackingStatus::kOk;
  const double min_overlap = config_.aligner.geometry.keyframe.min_overlap;
  result.keyframe = a.geometry && a.geometry->overlap < min_overlap;
  result.diagnostics = describe(*aligner_, a);
  return result;
}

TrackResult RenderTracker::lost(const alignment::Alignment& a) {
  motion_.hold();
  TrackResult result;
  result.status = TrackingStatus::kLost;
  result.lost_reason = a.lost_reason;
  result.T_odom_camera = motion_.pose();
  result.diagnostics = describe(*aligner_, a);
  return result;
}

}  // namespace sgs::tracker
