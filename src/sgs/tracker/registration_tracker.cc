// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/registration_tracker.h"

#include <optional>

#include "sgs/alignment/loss_checks.h"

namespace sgs::tracker {

RegistrationTracker::RegistrationTracker(const GicpConfig& config, const PinholeCamera& camera,
                                         const SE3& T_world_first)
    : config_(config),
      geometry_(config.geometry, camera, T_world_first.inverse()),
      motion_(config.motion, SE3{}),
      T_world_local_(T_world_first),
      past_(T_world_first.inverse()) {}

TrackResult RegistrationTracker::track(const RgbdFrame& frame, const history::Revision& revision,
                                       const map::SnapshotPtr& snapshot) {
  times_ = {};
  {
    const alignment::CpuTimer timer(times_.points);
    past_.set_revision(revision);
    geometry_.set_frame(frame, past_, snapshot);
  }
  look_at(frame);

  TrackResult result;
  const bool first = !geometry_.has_targets();
  std::optional<Registration> r;
  result.lost_reason =
      alignment::check_points(static_cast<int>(geometry_.source().points.size()), config_.loss);
  // The points as the camera saw them when it saw the colour, if it goes on as it did.
  result.motion = {Vector6d::Zero(), motion_.steady_rate(), frame.depth_delay_s};
  geometry_.set_motion(result.motion);
  if (!first && result.lost_reason == alignment::LostReason::kNone) {
    r = register_frame(frame.timestamp_s);
    result.lost_reason = judge(*r);
  }
  const SE3 T = r ? r->T_local_camera : motion_.pose();
  if (result.lost_reason == alignment::LostReason::kNone) {
    accept(T, frame.timestamp_s);
    result.keyframe = first || r->overlap < config_.geometry.keyframe.min_overlap;
    if (r && r->degenerate) result.status = TrackingStatus::kDegenerate;
  } else {
    hold();
    result.status = TrackingStatus::kLost;
  }
  if (result.keyframe) {
    const alignment::CpuTimer timer(times_.update);
    geometry_.insert_keyframe(T, result.motion);
  }
  result.T_odom_camera = (T_world_local_ * motion_.pose()).normalized();
  result.diagnostics = describe(r ? &*r : nullptr);
  return result;
}

alignment::LostReason RegistrationTracker::judge(const Registration& r) const {
  if (!r.T_local_camera.all_finite()) return alignment::LostReason::kNotFinite;
  const auto points = static_cast<int>(geometry_.source().points.size());
  const alignment::LostReason matches =
      alignment::check_matches(r.at_end.inliers, points, config_.loss);
  return matches != alignment::LostReason::kNone ? matches : motion_.judge(r.T_local_camera);
}

void RegistrationTracker::accept(const SE3& T_local_camera, double timestamp_s) {
  motion_.accept(T_local_camera, timestamp_s);
}

void RegistrationTracker::hold() { motion_.hold(); }

Diagnostics RegistrationTracker::describe(const Registration* r) const {
  Diagnostics d;
  note_times(times_, d);
  d.source_points = static_cast<int>(geometry_.source().points.size());
  d.targets = static_cast<int>(geometry_.targets().cloud().points.size());
  if (r != nullptr) {
    d.iterations = r->iterations;
    d.inliers = r->at_end.inliers;
    d.cost = r->cost;
    d.overlap = r->overlap;
  }
  describe_axes(r != nullptr, d);
  return d;
}

}  // namespace sgs::tracker
