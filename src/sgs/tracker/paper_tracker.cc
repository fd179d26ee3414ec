// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/paper_tracker.h"

#include "sgs/degeneracy/planarity.h"
#include "sgs/tracker/describe.h"

namespace sgs::tracker {
namespace {

// Mixes the bits of a target's number and returns one of them (the finaliser of splitmix64).
bool coin(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return ((x ^ (x >> 31)) & 1) != 0;
}

MotionConfig constant_velocity(MotionConfig config) {
  config.start = MotionStart::kConstantVelocity;
  return config;
}

}  // namespace

PaperTracker::PaperTracker(const PaperConfig& config, const PinholeCamera& camera,
                           const SE3& T_world_first)
    : RegistrationTracker(config.registration, camera, T_world_first),
      prior_config_(config.prior),
      visual_pose_(config.visual_pose),
      constant_motion_(constant_velocity(config.registration.motion), SE3{}),
      extractor_(config.orb) {}

void PaperTracker::accept(const SE3& T_local_camera, double timestamp_s) {
  RegistrationTracker::accept(T_local_camera, timestamp_s);
  constant_motion_.accept(T_local_camera, timestamp_s);
  if (prior_config_.source == PosePriorSource::kOrb) previous_ = std::move(current_);
}

void PaperTracker::hold() {
  RegistrationTracker::hold();
  constant_motion_.hold();
}

// The prior comes before registration, and whether or not it will be needed.
void PaperTracker::look_at(const RgbdFrame& frame) {
  const alignment::CpuTimer timer(times_.visual);
  was_active_ = axes_ && axes_->active;
  axes_.reset();
  prior_ = find_prior(frame);
  ++frames_;
}

PaperTracker::PosePrior PaperTracker::find_prior(const RgbdFrame& frame) {
  const bool wanted = frames_ >= prior_config_.first_frame;
  const PosePrior none{PriorSource::kNone, motion_.pose(), Matrix6d::Zero()};
  if (prior_config_.source == PosePriorSource::kOrb) {
    current_ = extractor_.extract(frame);
    return wanted && previous_ ? orb_prior() : none;
  }
  if (!wanted) return none;
  return {PriorSource::kConstantVelocity, constant_motion_.predict(frame.timestamp_s),
          Matrix6d::Identity()};
}

PaperTracker::PosePrior PaperTracker::orb_prior() const {
  const features::VisualPose seen =
      features::frame_to_frame_prior(*previous_, motion_.pose(), current_, visual_pose_);
  if (seen.verdict != features::Verdict::kOk) {
    return {PriorSource::kZero, motion_.pose(), Matrix6d::Identity(), seen.inliers};
  }
  return {PriorSource::kOrb, seen.T_world_camera, seen.information, seen.inliers};
}

RegistrationTracker::Registration PaperTracker::register_frame(double) {
  Registration r;
  r.T_local_camera = was_active_ ? prior_.T_local_camera : motion_.pose();
  if (!r.T_local_camera.all_finite()) return r;
  {
    const alignment::CpuTimer timer(times_.index);
    geometry_.prepare(r.T_local_camera);
  }
  const alignment::CpuTimer timer(times_.geometry);
  if (prior_config_.only && prior_.source != PriorSource::kNone) {
    axes_ = choose_axes(geometry_.linearize(r.T_local_camera).H);
    axes_->active = true;
    r.T_local_camera = prior_.T_local_camera;
  } else {
    const auto solution = minimise(r.T_local_camera);
    r.iterations = solution.iterations;
    r.T_local_camera = solution.T;
  }
  r.at_end = geometry_.linearize(r.T_local_camera);
  r.cost = r.at_end.error + 2 * degeneracy::prior_cost(axes_->prior, r.T_local_camera);
  r.overlap = geometry_.overlap(r.T_local_camera);
  r.degenerate = axes_->prior.mask != 0 || axes_->active;
  return r;
}

// Registration and prior together. Registration counts squared residuals, the prior half of them.
registration::PoseSolution PaperTracker::minimise(const SE3& T_start) {
  const registration::PoseProblem problem{
      [this](const SE3& T) {
        registration::Linearization l = geometry_.linearize(T);
        if (!axes_) axes_ = choose_axes(l.H);
        degeneracy::NormalEquations sum{l.H, l.b, 0.5 * l.error};
        degeneracy::add_prior(axes_->prior, T, sum);
        l.H = sum.H;
        l.b = sum.b;
        l.error = 2 * sum.cost;
        return l;
      },
      [this](const SE3& T) {
        return geometry_.error(T) + 2 * degeneracy::prior_cost(axes_->prior, T);
      }};
  return registration::solve_pose(config_.solver, problem, T_start);
}

// The condition test, planarity and the weights that follow from them; docs/method.md, sections 3,
// 4, 6.
PaperTracker::ChosenAxes PaperTracker::choose_axes(const Matrix6d& H_icp) const {
  ChosenAxes chosen;
  chosen.spectrum = degeneracy::spectrum(H_icp);
  chosen.planarity = planarity();
  degeneracy::DegeneracyConfig config = config_.degeneracy;
  double eta = chosen.planarity;
  if (!prior_config_.planarity) {
    config.soft_gate = false;
    eta = 0;  // and so the prior is never taken as a whole
  }
  // "No motion" stands in for a prior that was not seen. It locks axes that registration cannot
  // determine; that the surface looks flat is no reason to hold a pose which registration knows.
  if (prior_.source == PriorSource::kZero) config.planarity_alone = false;
  chosen.prior =
      degeneracy::make_axis_prior(H_icp, prior_.T_local_camera, prior_.information, eta, config);
  chosen.active = !chosen.prior.weight.isZero(0);
  const double gate =
      config.soft_gate ? degeneracy::planarity_gate(eta, config.planarity_alpha) : 1.0;
  for (unsigned k = 0; chosen.active && k < 6; ++k) {
    const bool degenerate = ((chosen.prior.mask >> k) & 1u) != 0;
    chosen.weights[k] = chosen.prior.full ? 1.0 : (degenerate ? gate : 0.0);
  }
  return chosen;
}

// The paper's score needs normals without a preferred side: on a plane it is their spread along the
// normal that makes the largest eigenvalue, and normals that all point towards the camera have
// none. Targets here are oriented (registration wants that), so each gets a sign from its number,
// as arbitrary and as lasting as the sign of an eigenvector.
double PaperTracker::planarity() const {
  alignment::GeometricTerm::MatchedTargets matched = geometry_.matched_targets();
  for (std::size_t i = 0; i < matched.normals.size(); ++i) {
    if (coin(static_cast<std::uint64_t>(matched.indices[i]) + 1)) matched.normals[i] *= -1;
  }
  return degeneracy::paper_planarity(matched.normals, matched.opacities, config_.degeneracy).eta;
}

void PaperTracker::describe_axes(bool, Diagnostics& d) const {
  d.prior_source = prior_.source;
  d.visual_inliers = prior_.inliers;
  if (!axes_) return;
  note_spectrum(axes_->spectrum, d);
  d.axes = axes_->spectrum.axes;
  d.planarity = axes_->planarity;
  d.degenerate_mask = axes_->prior.mask;
  d.prior_active = axes_->active;
  d.weights = axes_->weights;
}

}  // namespace sgs::tracker
