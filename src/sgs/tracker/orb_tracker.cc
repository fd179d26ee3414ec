// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/orb_tracker.h"

#include <numbers>

#include "sgs/alignment/step_times.h"

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

alignment::LostReason lost_reason(features::Verdict verdict) {
  switch (verdict) {
    case features::Verdict::kOk:
      return alignment::LostReason::kNone;
    case features::Verdict::kTooFewMatches:
      return alignment::LostReason::kTooFewFeatureMatches;
    case features::Verdict::kTooFewInliers:
      return alignment::LostReason::kTooFewFeatureInliers;
    case features::Verdict::kImplausibleMotion:
      return alignment::LostReason::kImplausibleMotion;
  }
  return alignment::LostReason::kNone;
}

}  // namespace

OrbTracker::OrbTracker(const OrbTrackerConfig& config, const SE3& T_world_first)
    : config_(config),
      extractor_(config.orb),
      map_(config.visual_pose),
      motion_(config.motion, T_world_first) {}

TrackResult OrbTracker::track(const RgbdFrame& frame, const history::Revision&,
                              const map::SnapshotPtr&) {
  TrackResult result;
  Diagnostics& d = result.diagnostics;
  alignment::StepTimes times;
  features::OrbFrame current;
  {
    const alignment::CpuTimer timer(times.points);
    current = extractor_.extract(frame);
  }
  d.source_points = summarise_depth(current).count;
  d.prior_source = PriorSource::kOrb;

  const bool first = map_.size() == 0;
  SE3 T = motion_.pose();
  int matches = 0;
  if (d.source_points < config_.visual_pose.min_matches) {
    result.lost_reason = alignment::LostReason::kTooFewFeatures;
  } else if (!first) {
    const alignment::CpuTimer timer(times.visual);
    features::VisualPose pose = localise(current, frame.timestamp_s);
    if (pose.verdict != features::Verdict::kOk) {
      if (const auto elsewhere = find_again(current)) {
        pose = *elsewhere;
        motion_.jump_to(pose.T_world_camera);
      }
    }
    result.lost_reason = lost_reason(pose.verdict);
    matches = pose.matches;
    d.inliers = d.visual_inliers = pose.inliers;
    T = pose.T_world_camera;
  }

  if (result.lost_reason != alignment::LostReason::kNone) {
    motion_.hold();
    result.status = TrackingStatus::kLost;
    T = motion_.pose();
  } else {
    motion_.accept(T, frame.timestamp_s);
    result.keyframe = first || wants_keyframe(current, T, matches);
  }
  if (result.keyframe) {
    const alignment::CpuTimer timer(times.update);
    insert_keyframe(current, T);
  }
  if (result.status != TrackingStatus::kLost) previous_ = std::move(current);
  note_times(times, d);
  result.T_odom_camera = T.normalized();
  return result;
}

// Against the local map, else against the last tracked frame; only a possible motion counts.
features::VisualPose OrbTracker::localise(const features::OrbFrame& current,
                                          double timestamp_s) const {
  features::VisualPose pose = map_.localise(current, motion_.predict(timestamp_s));
  if (pose.verdict == features::Verdict::kOk &&
      motion_.judge(pose.T_world_camera) != alignment::LostReason::kNone) {
    pose.verdict = features::Verdict::kImplausibleMotion;
  }
  if (pose.verdict == features::Verdict::kOk || !previous_) return pose;
  return features::frame_to_frame_prior(*previous_, motion_.pose(), current, config_.visual_pose);
}

// Among all keyframes, from the frame after the loss on and then now and then.
std::optional<features::VisualPose> OrbTracker::find_again(
    const features::OrbFrame& current) const {
  const int held = motion_.frames_held();
  if (held == 0 || (held - 1) % config_.tracking.relocalise_interval != 0) return std::nullopt;
  features::VisualPose pose = map_.relocalise(current);
  if (pose.verdict != features::Verdict::kOk) return std::nullopt;
  return pose;
}

bool OrbTracker::wants_keyframe(const features::OrbFrame& current, const SE3& T, int matches) {
  const OrbTrackingConfig& c = config_.tracking;
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
