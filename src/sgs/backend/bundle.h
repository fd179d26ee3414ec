// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "sgs/backend/bundle_problem.h"
#include "sgs/backend/bundle_rows.h"
#include "sgs/backend/bundle_sums.h"

namespace sgs::backend {

/// Standard deviations of what is left over, measured from the residuals themselves.
struct BundleNoise {
  double grey = 8;   ///< where the picture is flat
  double depth = 1;  ///< in units of the sensor's noise (camera/depth_noise.h)
};

/// The Gauss-Newton equations of a problem with the inverse depths eliminated. Order of the
/// unknowns: per keyframe its twist (right perturbation, rotation first), log gain and brightness
/// offset, turn during the readout; then the offsets of depth, the shift and the delay. The first
/// keyframe's pose is held.
struct BundleEquations {
  Eigen::MatrixXd H;  ///< upper triangle
  Eigen::VectorXd b;  ///< gradient: the step solves H x = -b
  double cost = 0;
  double grey_cost = 0, depth_cost = 0;  ///< of the residuals alone, as if all were independent
  int grey_residuals = 0, depth_residuals = 0;
  BundleNoise measured;  ///< from this linearization's residuals
};

/// Bundle adjustment of keyframes with a depth camera's calibration in it (docs/calibration.md).
/// Residuals as in BundleRows, weighted by a t distribution; the inverse depth of each pixel is
/// eliminated. Sequential: the same bits always.
class Bundle {
 public:
  Bundle(BundleProblem problem, BundleState start);

  /// Linearizes at a level of the pyramid with the noise given.
  BundleEquations linearize(int level, const BundleNoise& noise);
  /// Gives the memory of equations that are not needed any more to the next linearization.
  void reuse(BundleEquations&& equations) { H_ = std::move(equations.H); }
  /// Moves the state by a step of the last linearization's unknowns and the inverse depths along.
  void apply(const Eigen::VectorXd& step);
  /// Other priors of the calibration from here on.
  void set_priors(const CalibrationConfig& config) { problem_.config = config; }
  /// Holds the calibration at these values from here on; only the rest is adjusted.
  void hold(const DepthCalibration& calibration);

  const BundleState& state() const { return state_; }
  const BundleProblem& problem() const { return problem_; }
  int unknowns() const { return first_global() + grid_size() + 3; }
  /// Where the calibration's unknowns begin.
  int first_global() const;
  int grid_size() const { return problem_.grid.size(); }

 private:
  struct Measured;
  int calibration_size() const { return grid_size() + 3; }
  std::size_t block_of(int host, int target) const;
  WeightedRow weighted(int host, const BundleRow& row, const BundleNoise& noise) const;
  void collect_rows(const BundleRows& residuals, int host, std::size_t pixel, int level,
                    std::vector<BundleRow>& rows) const;
  void add_host(int host, const BundleSums& sums, BundleEquations& equations) const;
  void add_priors(BundleEquations& equations) const;
  void add_calibration_priors(BundleEquations& equations) const;
  void hold_calibration(BundleEquations& equations) const;
  void add_offset_priors(BundleEquations& equations) const;

  BundleProblem problem_;
  BundleState state_;
  std::vector<std::vector<Elimination>> eliminated_;
  // Of a linearization; kept, because the kernel clears new memory page by page.
  BundleSums sums_;
  Eigen::MatrixXd H_;
};

}  // namespace sgs::backend
