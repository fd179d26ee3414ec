// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/core/config.h"

namespace sgs::registration {

/// Which points of a depth image take part, and how their normal and noise are estimated.
struct SamplingConfig {
  std::string method = "plane_fit";  ///< plane_fit | neighbours (the paper)
  int step_px = 8;                   ///< spacing of the sampled pixels
  double min_depth_m = 0.1;
  double max_depth_m = 4.5;
  int window_px = 13;              ///< width of the fitted window, sampled every 2 px
  int min_samples = 12;            ///< of the fitted window, after rejection
  double max_incidence_deg = 80;   ///< between surface normal and viewing ray
  double noise_floor_m = 0.001;    ///< added in quadrature to the noise along the normal
  double independent_samples = 4;  ///< pixels of a window whose noise counts as independent
  double covariance_floor = 1e-3;  ///< smallest normalised eigenvalue of an ellipse

  void declare(ParameterList& p);
};

/// How source points find their targets.
struct SearchConfig {
  std::string method = "projective";  ///< projective | nearest
  int cell_px = 4;                    ///< cell size of the index image
  double max_distance_m = 0.05;       ///< gate between a source point and its target
  double min_normal_cosine = 0.8;     ///< gate between normals; -1 accepts all
  double keep_matches_m = 1e-3;       ///< a point that moved less keeps its match (at 2 m distance)

  void declare(ParameterList& p);
};

/// The residual and its robust weight.
struct FactorConfig {
  std::string type = "plane";  ///< plane | gicp
  double huber = 2.5;          ///< in standard deviations
  double reject = 10;          ///< residuals beyond this many standard deviations are dropped

  void declare(ParameterList& p);
};

/// The iteration on the pose.
struct SolverConfig {
  std::string method = "gauss_newton";  ///< gauss_newton | levenberg_marquardt
  int max_iterations = 10;
  double damping = 1e-3;      ///< absolute (Gauss-Newton) or relative to max diag (LM, lambda_0)
  double max_step_rad = 0.1;  ///< longer steps are shortened
  double max_step_m = 0.1;
  double stop_rad = 2e-4;  ///< converged when a step is shorter than both
  double stop_m = 2e-4;

  void declare(ParameterList& p);
};

}  // namespace sgs::registration
