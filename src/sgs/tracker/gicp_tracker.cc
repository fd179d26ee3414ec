// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/gicp_tracker.h"

#include "sgs/degeneracy/spectrum.h"
#include "sgs/registration/pose_solver.h"
#include "sgs/tracker/cpu_timer.h"

namespace sgs::tracker {
GicpTracker::GicpTracker(const TrackerConfig& config, const PinholeCamera& camera,
                         const SE3& T_world_first)
    : config_(config),
      T_world_map_(T_world_first),
      geometry_(config, camera, T_world_first.inverse()),
      motion_(config.motion, SE3{}) {}

TrackResult GicpTracker::track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
  TrackResult result;
  Diagnostics& d = result.diagnostics;
  {
    const CpuTimer timer(d.ms_points);
    geometry_.set_frame(frame, snapshot);
  }
  d.source_points = static_cast<int>(geometry_.source().points.size());

  const bool first = !geometry_.has_targets();
  SE3 T = motion_.pose();
  bool tracked = d.source_points >= config_.loss.min_points;
  if (tracked && !first) tracked = register_frame(frame.timestamp_s, T, d);
  if (!tracked) {
    motion_.hold();
    result.status = TrackingStatus::kLost;
    result.T_world_camera = T_world_map_ * motion_.pose();
    return result;
  }

  motion_.accept(T, frame.timestamp_s);
  result.keyframe = first || d.overlap < config_.keyframe.min_overlap;
  if (result.keyframe) {
    const CpuTimer timer(d.ms_update);
    geometry_.insert_keyframe(T);
  }
  if (d.degenerate_mask != 0) result.status = TrackingStatus::kDegenerate;
  result.T_world_camera = (T_world_map_ * T).normalized();
  return result;
}

// Registers the frame from the predicted pose; false when the outcome cannot be trusted.
bool GicpTracker::register_frame(double timestamp_s, SE3& T_map_camera, Diagnostics& d) {
  const SE3 T_predicted = motion_.predict(timestamp_s);
  {
    const CpuTimer timer(d.ms_index);
    geometry_.prepare(T_predicted);
  }
  const CpuTimer timer(d.ms_geometry);
  const registration::PoseProblem problem{[this](const SE3& T) { return geometry_.linearize(T); },
                                          [this](const SE3& T) { return geometry_.error(T); }};
  const auto solution = registration::solve_pose(config_.solver, problem, T_predicted);
  const registration::Linearization at_end = geometry_.linearize(solution.T);
  d.iterations = solution.iterations;
  d.inliers = at_end.inliers;
  d.cost = at_end.error;
  d.overlap = geometry_.overlap(solution.T);
  describe_spectrum(at_end.H, d);
  T_map_camera = solution.T;
  return d.inliers >= config_.loss.min_inliers &&
         d.inliers >= config_.loss.min_inlier_share * d.source_points &&
         motion_.plausible(solution.T);
}

// Which directions the frame's geometry sees. The default detector needs the noise of the normals,
// which only the plane fit gives; with the paper's sampling its condition number decides.
void GicpTracker::describe_spectrum(const Matrix6d& H, Diagnostics& d) {
  const degeneracy::Spectrum spectrum = degeneracy::spectrum(H);
  for (int k = 0; k < 6; ++k) d.eigenvalues[static_cast<std::size_t>(k)] = spectrum.eigenvalues[k];
  d.condition_number = spectrum.condition_number();
  if (config_.points.method != "plane_fit") {
    d.degenerate_mask =
        degeneracy::condition_mask(spectrum, config_.degeneracy.condition_threshold);
    for (unsigned k = 0; k < 6; ++k) d.weights[k] = (d.degenerate_mask >> k) & 1u;
    d.axes = spectrum.axes;
    return;
  }
  const auto observability =
      degeneracy::observe(geometry_.surface_information(), config_.degeneracy, hysteresis_);
  for (int k = 0; k < 6; ++k) {
    d.snr[static_cast<std::size_t>(k)] = observability.snr[k];
    d.weights[static_cast<std::size_t>(k)] = observability.weights[k];
  }
  d.axes = observability.camera_axes;
  d.degenerate_mask = observability.mask;
}

}  // namespace sgs::tracker
