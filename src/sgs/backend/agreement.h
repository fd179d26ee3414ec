// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace sgs::backend {

/// The parts of a calibration: each is believed, or held at nothing, on its own.
struct CalibrationParts {
  bool mean = false, shape = false, shift = false, delay = false;

  bool any() const { return mean || shape || shift || delay; }
  /// In words: "shift, delay"; empty for none.
  std::string names() const;
  friend bool operator==(const CalibrationParts&, const CalibrationParts&) = default;
};

CalibrationParts operator|(const CalibrationParts& a, const CalibrationParts& b);
CalibrationParts operator&(const CalibrationParts& a, const CalibrationParts& b);
/// In a and not in b.
CalibrationParts without(const CalibrationParts& a, const CalibrationParts& b);

/// What some keyframes say of the depth camera before anything insignificant is held at nothing.
struct FreeEstimate {
  double mean_per_m = 0, mean_sigma_per_m = 0;
  /// Per node of the grid, about the mean; all three of one size.
  std::vector<double> shape_per_m, shape_sigma_per_m;
  std::vector<double> area;  ///< share of the image, adds up to 1
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d shift_covariance = Eigen::Matrix2d::Zero();
  double delay_s = 0, delay_sigma_s = 0;
};

/// By how much two estimates differ, part by part: in the deviations that they give themselves
/// together, and half of the difference, which is what a deviation of their mean must not be below.
struct Disagreement {
  struct Of {
    double sigmas = 0;  ///< RMS over the nodes for the shape
    double half = 0;    ///< in the part's own unit; RMS over the image for the shape
    double size = 0;    ///< of their mean, likewise
  };
  Of mean, shape, shift, delay;
  std::vector<double> half_shape_per_m;  ///< per node
  Eigen::Vector2d half_shift_px = Eigen::Vector2d::Zero();
};

/// Both over the same grid.
Disagreement compare(const FreeEstimate& a, const FreeEstimate& b);

/// Which parts two halves of a recording say differently: by more than three deviations (the shape:
/// more than the square root of three of them, in the mean over the image), and by more than what
/// is of no consequence (0.1 px, 0.5 ms, 0.0001 /m), and by
/// so much that half of it is more than a fifth of what they say together: 16 and 17 ms are still a
/// delay of 16.5 to half a millisecond.
CalibrationParts contradicted(const Disagreement& d);

/// How well keyframes fit together: mean cost of a residual, in units of its noise.
struct Fit {
  double grey = 0, depth = 0;
  int grey_residuals = 0, depth_residuals = 0;
};

/// Adds those of other keyframes.
Fit operator+(const Fit& a, const Fit& b);

/// Whether keyframes fit better with a calibration than without it: pictures and depths together,
/// in units of what either costs without it; neither alone worse by more than 2 %, nor fewer than
/// 95 % of the places found again.
bool fits_better(const Fit& with, const Fit& without);

}  // namespace sgs::backend
