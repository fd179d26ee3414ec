// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "sgs/camera/pyramid.h"
#include "sgs/registration/cell_mask.h"
#include "sgs/registration/photometric.h"

namespace sgs::registration {

/// Unknowns of one reference, in this order: twist, turn of the readout, gain, offset.
inline constexpr int kPhotometricPose = 6, kPhotometricReadout = 3, kPhotometricUnknowns = 11;

/// What the residuals of a level have in common.
struct PhotometricView {
  const GrayPyramid::Level* image = nullptr;
  const DepthImage* depth = nullptr;  ///< full size
  int level = 0;
  Eigen::Matrix3f R;  ///< from the keyframe to the current camera
  Eigen::Vector3f t;
  ReadoutMotion readout;
  float gain = 1, offset = 0;
  float depth_gate_m = 0, depth_gate_ratio = 0;
  float t_dof = 1, inverse_variance = 1;
  const CellMask* moving = nullptr;  ///< pixels there do not count; null: none
  bool with_readout = true;          ///< off: the rows and columns of the readout stay zero
};

/// Normal equations before anything is eliminated.
struct PhotometricSums {
  Eigen::Matrix<double, kPhotometricUnknowns, kPhotometricUnknowns> H =
      Eigen::Matrix<double, kPhotometricUnknowns, kPhotometricUnknowns>::Zero();
  Eigen::Matrix<double, kPhotometricUnknowns, 1> b =
      Eigen::Matrix<double, kPhotometricUnknowns, 1>::Zero();
  double log_sum = 0;     ///< sum of ln(1 + r^2 / (nu sigma^2))
  double square_sum = 0;  ///< sum of w r^2, w the weights: one a pixel where sigma is right
  int used = 0, visible = 0;
  int gone = 0;  ///< in the image, but where something moves, or looked through where it did
};

/// Sums over `points` in float, block by block in double. Same bits for the same instruction set.
PhotometricSums sum_photometric(const PhotometricView& view,
                                std::span<const PhotometricPoint> points);

}  // namespace sgs::registration
