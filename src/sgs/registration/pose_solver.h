// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "sgs/registration/linearization.h"
#include "sgs/registration/registration_config.h"

namespace sgs::registration {

/// A cost of a pose, as the solver sees it.
struct PoseProblem {
  std::function<Linearization(const SE3& T)> linearize;
  /// Cost of a trial pose, comparable with the last linearize(); used by Levenberg-Marquardt.
  std::function<double(const SE3& T)> error;
};

struct PoseSolution {
  SE3 T;
  Linearization last;      ///< linearisation the last step was computed from
  int iterations = 0;      ///< linearisations
  bool converged = false;  ///< the last step was below the stop thresholds
};

/// Solves (H + damping) xi = -b and shortens the step to the caps. Zero when that has no finite
/// solution.
Vector6d damped_step(const Linearization& system, double damping, const SolverConfig& config);

/// Minimises the cost over SE(3) from `T_start` with steps T <- T exp(xi). Gauss-Newton takes every
/// step; Levenberg-Marquardt only those that lower the cost, raising lambda tenfold until one does.
PoseSolution solve_pose(const SolverConfig& config, const PoseProblem& problem, const SE3& T_start);

}  // namespace sgs::registration
