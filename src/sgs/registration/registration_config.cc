// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/registration_config.h"

namespace sgs::registration {

void SamplingConfig::declare(ParameterList& p) {
  p.add("method", method,
        "Normals and noise from an inverse-depth plane fit, or ellipses of 10 neighbours.",
        {"plane_fit", "neighbours"});
  p.add("step_px", step_px, "Spacing of the sampled pixels.", "px", {2, 64});
  p.add("min_depth_m", min_depth_m, "Nearer measurements are ignored.", "m", {0.01, 10});
  p.add("max_depth_m", max_depth_m, "Farther measurements are ignored.", "m", {0.1, 100});
  p.add("window_px", window_px, "Width of the window of the plane fit.", "px", {5, 15});
  p.add("min_samples", min_samples, "Least number of pixels that support a plane fit.", "px",
        {4, 64});
  p.add("max_incidence_deg", max_incidence_deg, "Surfaces seen at a flatter angle are ignored.",
        "deg", {10, 90});
  p.add("noise_floor_m", noise_floor_m, "Least standard deviation of a point along its normal.",
        "m", {1e-5, 0.1});
  p.add("independent_samples", independent_samples,
        "Pixels of a window whose noise counts as independent.", "px", {1, 64});
  p.add("covariance_floor", covariance_floor, "Smallest eigenvalue of a normalised ellipse.", "",
        {1e-6, 1});
}

void SearchConfig::declare(ParameterList& p) {
  p.add("method", method, "Search in an index image of the map, or for the nearest mean.",
        {"projective", "nearest"});
  p.add("cell_px", cell_px, "Cell size of the index image.", "px", {1, 64});
  p.add("max_distance_m", max_distance_m, "Gate between a point and its target.", "m", {1e-3, 1});
  p.add("min_normal_cosine", min_normal_cosine,
        "Gate between the normals of a point and its target; -1 accepts all.", "", {-1, 1});
  p.add("keep_matches_m", keep_matches_m,
        "Iterations that moved points at 2 m by less keep their matches; 0 always searches.", "m",
        {0, 1});
}

void FactorConfig::declare(ParameterList& p) {
  p.add("type", type, "Point to plane with the noise along the normal, or G-ICP ellipses.",
        {"plane", "gicp"});
  p.add("huber", huber, "Residuals beyond this are weighted down (Huber).", "sigma", {0.1, 100});
  p.add("reject", reject, "Residuals beyond this are dropped.", "sigma", {1, 1e9});
}

void SolverConfig::declare(ParameterList& p) {
  p.add("method", method, "Iteration on the pose.", {"gauss_newton", "levenberg_marquardt"});
  p.add("max_iterations", max_iterations, "Upper limit of iterations.", "", {1, 1000});
  p.add("damping", damping,
        "Added to the diagonal (Gauss-Newton), or first lambda relative to the largest diagonal "
        "entry (Levenberg-Marquardt).",
        "", {0, 1e6});
  p.add("max_step_rad", max_step_rad, "Longer rotation steps are shortened.", "rad", {1e-4, 3});
  p.add("max_step_m", max_step_m, "Longer translation steps are shortened.", "m", {1e-4, 10});
  p.add("stop_rad", stop_rad, "Converged when a step is shorter.", "rad", {0, 1});
  p.add("stop_m", stop_m, "Converged when a step is shorter.", "m", {0, 1});
}

}  // namespace sgs::registration
