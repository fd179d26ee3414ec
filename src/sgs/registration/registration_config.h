// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::registration {

enum class SamplingMethod { kPlaneFit, kNeighbours };
constexpr auto enum_names(SamplingMethod) {
  using enum SamplingMethod;
  return std::to_array<EnumName<SamplingMethod>>(
      {{kPlaneFit, "plane_fit"}, {kNeighbours, "neighbours"}});
}

enum class SearchMethod { kProjective, kNearest };
constexpr auto enum_names(SearchMethod) {
  using enum SearchMethod;
  return std::to_array<EnumName<SearchMethod>>(
      {{kProjective, "projective"}, {kNearest, "nearest"}});
}

enum class FactorType { kPlane, kGicp };
constexpr auto enum_names(FactorType) {
  using enum FactorType;
  return std::to_array<EnumName<FactorType>>({{kPlane, "plane"}, {kGicp, "gicp"}});
}

enum class SolverMethod { kGaussNewton, kLevenbergMarquardt };
constexpr auto enum_names(SolverMethod) {
  using enum SolverMethod;
  return std::to_array<EnumName<SolverMethod>>(
      {{kGaussNewton, "gauss_newton"}, {kLevenbergMarquardt, "levenberg_marquardt"}});
}

/// Which points of a depth image take part, and how their normal and noise are estimated.
struct SamplingConfig {
  SamplingMethod method = SamplingMethod::kPlaneFit;
  int step_px = 8;
  double min_depth_m = 0.1;
  double max_depth_m = 4.5;
  int window_px = 13;
  int min_samples = 12;
  double max_incidence_deg = 80;
  double noise_floor_m = 0.001;
  double independent_samples = 4;
  double covariance_floor = 1e-3;

  void declare(ParameterList& p) {
    p.add("method", method,
          "Normals and noise from an inverse-depth plane fit, or ellipses of 10 neighbours (the "
          "paper).");
    p.add("step_px", step_px, "Spacing of the sampled pixels.", "px", {2, 64});
    p.add("min_depth_m", min_depth_m, "Nearer measurements are ignored.", "m", {0.01, 10});
    p.add("max_depth_m", max_depth_m, "Farther measurements are ignored.", "m", {0.1, 100});
    p.add("window_px", window_px, "Width of the window of the plane fit, sampled every 2 px.", "px",
          {5, 15});
    p.add("min_samples", min_samples,
          "Least number of pixels that support a plane fit, after rejection.", "px", {4, 64});
    p.add("max_incidence_deg", max_incidence_deg,
          "Surfaces seen at a larger angle between normal and viewing ray are ignored.", "deg",
          {10, 90});
    p.add("noise_floor_m", noise_floor_m,
          "Least standard deviation of a point along its normal, added in quadrature.", "m",
          {1e-5, 0.1});
    p.add("independent_samples", independent_samples,
          "Pixels of a window whose noise counts as independent.", "px", {1, 64});
    p.add("covariance_floor", covariance_floor, "Smallest eigenvalue of a normalised ellipse.", "",
          {1e-6, 1});
  }
};

/// How source points find their targets.
struct SearchConfig {
  SearchMethod method = SearchMethod::kProjective;
  int cell_px = 4;
  double max_distance_m = 0.05;
  double min_normal_cosine = 0.8;
  double keep_matches_m = 1e-3;

  void declare(ParameterList& p) {
    p.add("method", method, "Search in an index image of the map, or for the nearest mean.");
    p.add("cell_px", cell_px, "Cell size of the index image.", "px", {1, 64});
    p.add("max_distance_m", max_distance_m, "Gate between a point and its target.", "m", {1e-3, 1});
    p.add("min_normal_cosine", min_normal_cosine,
          "Gate between the normals of a point and its target; -1 accepts all.", "", {-1, 1});
    p.add("keep_matches_m", keep_matches_m,
          "Iterations that moved points at 2 m by less keep their matches; 0 always searches.", "m",
          {0, 1});
  }
};

/// The residual and its robust weight.
struct FactorConfig {
  FactorType type = FactorType::kPlane;
  double huber = 2.5;
  double reject = 10;

  void declare(ParameterList& p) {
    p.add("type", type, "Point to plane with the noise along the normal, or G-ICP ellipses.");
    p.add("huber", huber, "Residuals beyond this are weighted down (Huber).", "sigma", {0.1, 100});
    p.add("reject", reject, "Residuals beyond this are dropped.", "sigma", {1, 1e9});
  }
};

/// The iteration on the pose.
struct SolverConfig {
  SolverMethod method = SolverMethod::kGaussNewton;
  int max_iterations = 10;
  double damping = 1e-3;
  double max_step_rad = 0.1;
  double max_step_m = 0.1;
  double stop_rad = 2e-4;
  double stop_m = 2e-4;

  void declare(ParameterList& p) {
    p.add("method", method, "Iteration on the pose.");
    p.add("max_iterations", max_iterations, "Upper limit of iterations.", "", {1, 1000});
    p.add("damping", damping,
          "Added to the diagonal (Gauss-Newton), or first lambda relative to the largest diagonal "
          "entry (Levenberg-Marquardt).",
          "", {0, 1e6});
    p.add("max_step_rad", max_step_rad, "Longer rotation steps are shortened.", "rad", {1e-4, 3});
    p.add("max_step_m", max_step_m, "Longer translation steps are shortened.", "m", {1e-4, 10});
    p.add("stop_rad", stop_rad,
          "Converged when a step turns by less and moves by less than stop_m.", "rad", {0, 1});
    p.add("stop_m", stop_m, "Converged when a step moves by less and turns by less than stop_rad.",
          "m", {0, 1});
  }
};

}  // namespace sgs::registration
