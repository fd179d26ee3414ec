// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/gicp_tracker.h"

#include "sgs/tracker/describe.h"

namespace sgs::tracker {

RegistrationTracker::Registration GicpTracker::register_frame(double timestamp_s) {
  const SE3 T_predicted = motion_.predict(timestamp_s);
  Registration r;
  r.T_local_camera = T_predicted;
  if (!T_predicted.all_finite()) return r;
  {
    const alignment::CpuTimer timer(times_.index);
    geometry_.prepare(T_predicted);
  }
  const alignment::CpuTimer timer(times_.geometry);
  const registration::PoseProblem problem{[this](const SE3& T) { return geometry_.linearize(T); },
                                          [this](const SE3& T) { return geometry_.error(T); }};
  const auto solution = registration::solve_pose(config_.solver, problem, T_predicted);
  r.T_local_camera = solution.T;
  r.iterations = solution.iterations;
  r.at_end = geometry_.linearize(solution.T);
  r.cost = r.at_end.error;
  r.overlap = geometry_.overlap(solution.T);
  find_unseen_axes(r.at_end.H);
  r.degenerate = mask_ != 0;
  return r;
}

void GicpTracker::find_unseen_axes(const Matrix6d& H) {
  spectrum_ = degeneracy::spectrum(H);
  if (by_condition_) {
    mask_ = degeneracy::condition_mask(spectrum_, config_.degeneracy.condition_threshold);
    return;
  }
  observability_ =
      degeneracy::observe(geometry_.surface_information(config_.degeneracy.noise_stride),
                          config_.degeneracy, hysteresis_);
  mask_ = observability_.mask;
}

void GicpTracker::describe_axes(bool registered, Diagnostics& d) const {
  if (!registered) return;
  note_spectrum(spectrum_, d);
  if (!by_condition_) return note_observability(observability_, d);
  d.axes = spectrum_.axes;
  d.degenerate_mask = mask_;
  for (unsigned k = 0; k < 6; ++k) d.weights[k] = (mask_ >> k) & 1u;
}

}  // namespace sgs::tracker
