// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/pose_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace sgs::registration {
namespace {

constexpr double kLambdaFactor = 10;
constexpr double kMinLambda = 1e-12;
constexpr int kMaxTrials = 8;

bool is_small(const Vector6d& xi, const SolverConfig& config) {
  return xi.head<3>().norm() < config.stop_rad && xi.tail<3>().norm() < config.stop_m;
}

}  // namespace

Vector6d damped_step(const Linearization& system, double damping, const SolverConfig& config) {
  Matrix6d H = system.H;
  H.diagonal().array() += damping;
  Vector6d xi = -H.ldlt().solve(system.b);
  if (!xi.allFinite()) return Vector6d::Zero();
  const double angle = xi.head<3>().norm(), length = xi.tail<3>().norm();
  double scale = 1;
  if (angle > config.max_step_rad) scale = config.max_step_rad / angle;
  if (length > config.max_step_m) scale = std::min(scale, config.max_step_m / length);
  return scale * xi;
}

PoseSolution solve_pose(const SolverConfig& config, const PoseProblem& problem,
                        const SE3& T_start) {
  const bool lm = config.method == SolverMethod::kLevenbergMarquardt;
  PoseSolution s;
  s.T = T_start;
  double lambda = -1;  // follows from the first Hessian
  while (s.iterations < config.max_iterations && !s.converged) {
    s.last = problem.linearize(s.T);
    ++s.iterations;
    if (s.last.inliers == 0) break;
    if (!lm) {
      const Vector6d xi = damped_step(s.last, config.damping, config);
      s.T = s.T * SE3::exp(xi);
      s.converged = is_small(xi, config);
      continue;
    }
    if (lambda < 0) lambda = config.damping * s.last.H.diagonal().maxCoeff();
    bool accepted = false;
    for (int trial = 0; trial < kMaxTrials && !accepted; ++trial) {
      const Vector6d xi = damped_step(s.last, lambda, config);
      const SE3 T_trial = s.T * SE3::exp(xi);
      s.converged = is_small(xi, config);
      accepted = problem.error(T_trial) < s.last.error;
      if (accepted) {
        s.T = T_trial;
        lambda = std::max(lambda / kLambdaFactor, kMinLambda);
      } else {
        lambda *= kLambdaFactor;
        if (s.converged) break;  // a step too short to matter did not help either
      }
    }
    if (!accepted) break;
  }
  s.T = s.T.normalized();
  return s;
}

}  // namespace sgs::registration
