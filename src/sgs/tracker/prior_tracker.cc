// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/prior_tracker.h"

#include "sgs/degeneracy/planarity.h"
#include "sgs/degeneracy/spectrum.h"
#include "sgs/registration/pose_solver.h"
#include "sgs/tracker/cpu_timer.h"

namespace sgs::tracker {
namespace {

// Mixes the bits of a target's number and returns one of them (the finaliser of splitmix64).
bool coin(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return ((x ^ (x >> 31)) & 1) != 0;
}

MotionConfig constant_velocity(MotionConfig config) {
  config.start = "constant_velocity";
  return config;
}

}  // namespace

PriorTracker::PriorTracker(const TrackerConfig& config, const PinholeCamera& camera,
                           const SE3& T_world_first)
    : config_(config),
      T_world_map_(T_world_first),
      geometry_(config, camera, T_world_first.inverse()),
      motion_(config.motion, SE3{}),
      constant_motion_(constant_velocity(config.motion), SE3{}),
      extractor_(config.orb) {}

TrackResult PriorTracker::track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
  TrackResult result;
  Diagnostics& d = result.diagnostics;
  {
    const CpuTimer timer(d.ms_points);
    geometry_.set_frame(frame, snapshot);
  }
  d.source_points = static_cast<int>(geometry_.source().points.size());
  const bool first = !geometry_.has_targets();
  PosePrior prior;
  {
    const CpuTimer timer(d.ms_visual);
    prior = find_prior(frame, d);
  }
  ++frames_;

  SE3 T = motion_.pose();
  bool tracked = d.source_points >= config_.loss.min_points;
  if (tracked && !first) tracked = register_frame(prior, T, d);
  was_active_ = d.prior_active;
  if (!tracked) {
    motion_.hold();
    constant_motion_.hold();
    result.status = TrackingStatus::kLost;
    result.T_world_camera = (T_world_map_ * motion_.pose()).normalized();
    return result;
  }

  accept(T, frame.timestamp_s);
  result.keyframe = first || d.overlap < config_.keyframe.min_overlap;
  if (result.keyframe) {
    const CpuTimer timer(d.ms_update);
    geometry_.insert_keyframe(T);
  }
  if (d.degenerate_mask != 0 || d.prior_active) result.status = TrackingStatus::kDegenerate;
  result.T_world_camera = (T_world_map_ * T).normalized();
  return result;
}

void PriorTracker::accept(const SE3& T_map_camera, double timestamp_s) {
  motion_.accept(T_map_camera, timestamp_s);
  constant_motion_.accept(T_map_camera, timestamp_s);
  if (config_.prior.source == "orb") previous_ = std::move(current_);
}

// Where the prior sees the camera: before registration, and whether or not it will be needed.
PriorTracker::PosePrior PriorTracker::find_prior(const RgbdFrame& frame, Diagnostics& d) {
  const bool wanted = frames_ >= config_.prior.first_frame;
  PosePrior prior{motion_.pose(), Matrix6d::Zero()};
  if (config_.prior.source == "cvm") {
    if (!wanted) return prior;
    d.prior_source = "cvm";
    return {constant_motion_.predict(frame.timestamp_s), Matrix6d::Identity()};
  }
  current_ = extractor_.extract(frame);
  if (!wanted || !previous_) return prior;
  const features::VisualPose seen =
      features::frame_to_frame_prior(*previous_, motion_.pose(), current_, config_.visual_pose);
  d.visual_inliers = seen.inliers;
  if (seen.verdict == features::Verdict::kOk) {
    d.prior_source = "orb";
    return {seen.T_world_camera, seen.information};
  }
  d.prior_source = "zero";
  prior.information.setIdentity();
  return prior;
}

// Minimises registration and prior together; false when the outcome cannot be trusted.
bool PriorTracker::register_frame(const PosePrior& prior, SE3& T_map_camera, Diagnostics& d) {
  const SE3 T_start = was_active_ ? prior.T_map_camera : motion_.pose();
  {
    const CpuTimer timer(d.ms_index);
    geometry_.prepare(T_start);
  }
  const CpuTimer timer(d.ms_geometry);
  std::optional<degeneracy::AxisPrior> axes;  // frozen at the first linearisation
  // Registration counts squared residuals, the prior half of them.
  const registration::PoseProblem problem{
      [&](const SE3& T) {
        registration::Linearization l = geometry_.linearize(T);
        if (!axes) axes = choose_axes(l.H, prior, d);
        degeneracy::NormalEquations sum{l.H, l.b, 0.5 * l.error};
        degeneracy::add_prior(*axes, T, sum);
        l.H = sum.H;
        l.b = sum.b;
        l.error = 2 * sum.cost;
        return l;
      },
      [&](const SE3& T) { return geometry_.error(T) + 2 * degeneracy::prior_cost(*axes, T); }};
  SE3 T = prior.T_map_camera;
  if (!config_.prior.only || d.prior_source == "none") {
    const auto solution = registration::solve_pose(config_.solver, problem, T_start);
    d.iterations = solution.iterations;
    T = solution.T;
  } else {
    axes = choose_axes(geometry_.linearize(T_start).H, prior, d);
    d.prior_active = true;
  }
  const registration::Linearization at_end = geometry_.linearize(T);
  d.inliers = at_end.inliers;
  d.cost = at_end.error + 2 * degeneracy::prior_cost(*axes, T);
  d.overlap = geometry_.overlap(T);
  T_map_camera = T;
  return d.inliers >= config_.loss.min_inliers &&
         d.inliers >= config_.loss.min_inlier_share * d.source_points && motion_.plausible(T);
}

// The condition test, planarity and the weights that follow from them; docs/method.md, sections 3,
// 4, 6.
degeneracy::AxisPrior PriorTracker::choose_axes(const Matrix6d& H_icp, const PosePrior& prior,
                                                Diagnostics& d) {
  const degeneracy::Spectrum spectrum = degeneracy::spectrum(H_icp);
  d.condition_number = spectrum.condition_number();
  for (int k = 0; k < 6; ++k) d.eigenvalues[static_cast<std::size_t>(k)] = spectrum.eigenvalues[k];
  d.axes = spectrum.axes;
  d.planarity = planarity();
  degeneracy::DegeneracyConfig config = config_.degeneracy;
  double eta = d.planarity;
  if (!config_.prior.planarity) {
    config.soft_gate = false;
    eta = 0;  // and so the prior is never taken as a whole
  }
  // "No motion" stands in for a prior that was not seen. It locks axes that registration cannot
  // determine; that the surface looks flat is no reason to hold a pose which registration knows.
  if (d.prior_source == "zero") config.planarity_alone = false;
  degeneracy::AxisPrior axes =
      degeneracy::make_axis_prior(H_icp, prior.T_map_camera, prior.information, eta, config);
  d.degenerate_mask = axes.mask;
  d.prior_active = !axes.weight.isZero(0);
  const double gate =
      config.soft_gate ? degeneracy::planarity_gate(eta, config.planarity_alpha) : 1.0;
  for (unsigned k = 0; d.prior_active && k < 6; ++k) {
    const bool degenerate = ((axes.mask >> k) & 1u) != 0;
    d.weights[k] = axes.full ? 1.0 : (degenerate ? gate : 0.0);
  }
  return axes;
}

// The paper's score needs normals without a preferred side: on a plane it is their spread along the
// normal that makes the largest eigenvalue, and normals that all point towards the camera have
// none. Targets here are oriented (registration wants that), so each gets a sign from its number,
// as arbitrary and as lasting as the sign of an eigenvector.
double PriorTracker::planarity() const {
  GeometricTerm::MatchedTargets matched = geometry_.matched_targets();
  for (std::size_t i = 0; i < matched.normals.size(); ++i) {
    if (coin(static_cast<std::uint64_t>(matched.indices[i]) + 1)) matched.normals[i] *= -1;
  }
  return degeneracy::paper_planarity(matched.normals, matched.opacities, config_.degeneracy).eta;
}

}  // namespace sgs::tracker
