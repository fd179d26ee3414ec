// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/orb_tracker.h"

#include <numbers>

#include "sgs/tracker/cpu_timer.h"

namespace sgs::tracker {
namespace {

// Features whose depth is measured: only those become points of the map.
struct DepthSummary {
  int count = 0;
  double mean_m = 0;
};

DepthSummary summarise_depth(const features::OrbFrame& frame) {
  DepthSummary s;
  for (const features::Keypoint& k : frame.keypoints) {
    if (!(k.depth_m > 0)) continue;
    ++s.count;
    s.mean_m += static_cast<double>(k.depth_m);
  }
  if (s.count > 0) s.mean_m /= s.count;
  return s;
}

}  // namespace

OrbTracker::OrbTracker(const TrackerConfig& config, const SE3& T_world_first)
    : config_(config),
      extractor_(config.orb),
      map_(config.visual_pose),
      motion_(config.motion, T_world_first) {}

TrackResult OrbTracker::track(const RgbdFrame& frame, const map::SnapshotPtr&) {
  TrackResult result;
  Diagnostics& d = result.diagnostics;
  features::OrbFrame current;
  {
    const CpuTimer timer(d.ms_points);
    current = extractor_.extract(frame);
  }
  d.source_points = summarise_depth(current).count;
  d.prior_source = "orb";

  const bool first = map_.size() == 0;
  bool tracked = d.source_points >= config_.visual_pose.min_matches;
  bool elsewhere = false;
  SE3 T = motion_.pose();
  int matches = 0;
  if (!first && tracked) {
    const CpuTimer timer(d.ms_visual);
    features::VisualPose pose = localise(current, frame.timestamp_s);
    if (pose.verdict != features::Verdict::kOk) pose = find_again(current, elsewhere);
    tracked = pose.verdict == features::Verdict::kOk;
    matches = pose.matches;
    d.inliers = d.visual_inliers = pose.inliers;
    T = pose.T_world_camera;
  }
  if (!tracked) {
    motion_.hold();
    result.status = TrackingStatus::kLost;
    result.T_world_camera = motion_.pose();
    return result;
  }

  if (elsewhere) motion_ = MotionModel(config_.motion, T);  // a jump is no velocity
  motion_.accept(T, frame.timestamp_s);
  result.keyframe = first || wants_keyframe(current, T, matches);
  if (result.keyframe) {
    const CpuTimer timer(d.ms_update);
    insert_keyframe(current, T);
  }
  previous_ = std::move(current);
  result.T_world_camera = T.normalized();
  return result;
}

// Against the local map, else against the last tracked frame; only a possible motion counts.
features::VisualPose OrbTracker::localise(const features::OrbFrame& current,
                                          double timestamp_s) const {
  features::VisualPose pose = map_.localise(current, motion_.predict(timestamp_s));
  if (pose.verdict == features::Verdict::kOk && !motion_.plausible(pose.T_world_camera)) {
    pose.verdict = features::Verdict::kImplausibleMotion;
  }
  if (pose.verdict == features::Verdict::kOk || !previous_) return pose;
  return features::frame_to_frame_prior(*previous_, motion_.pose(), current, config_.visual_pose);
}

// Among all keyframes, from the frame after the loss on and then now and then.
features::VisualPose OrbTracker::find_again(const features::OrbFrame& current, bool& elsewhere) {
  const int held = motion_.frames_held();
  if (held == 0 || (held - 1) % config_.orb_tracking.relocalise_interval != 0) return {};
  features::VisualPose pose = map_.relocalise(current);
  elsewhere = pose.verdict == features::Verdict::kOk;
  return pose;
}

bool OrbTracker::wants_keyframe(const features::OrbFrame& current, const SE3& T, int matches) {
  const OrbTrackingConfig& c = config_.orb_tracking;
  if (summarise_depth(current).count < config_.visual_pose.min_matches) return false;
  if (keyframe_matches_ == 0) keyframe_matches_ = matches;
  const SE3 motion = T_keyframe_.inverse() * T;
  return motion.t.norm() > c.keyframe_translation * keyframe_depth_m_ ||
         motion.angle() > c.keyframe_rotation_deg * std::numbers::pi / 180 ||
         matches < c.keyframe_matches * keyframe_matches_;
}

void OrbTracker::insert_keyframe(const features::OrbFrame& current, const SE3& T) {
  features::OrbFrame copy = current;
  copy.descriptors = current.descriptors.clone();
  map_.insert(std::move(copy), T);
  T_keyframe_ = T;
  keyframe_depth_m_ = summarise_depth(current).mean_m;
  keyframe_matches_ = 0;
}

}  // namespace sgs::tracker
