// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"

namespace sgs {

/// Bilinear weights of a pixel on a coarse grid: four nodes and their shares.
struct GridWeights {
  std::array<int, 4> node;  ///< row by row of the grid
  std::array<double, 4> weight;
};

/// A grid of values over an image, bilinear between its nodes; the outermost nodes lie on the
/// outermost pixels.
struct ImageGrid {
  int columns = 0, rows = 0;

  int size() const { return columns * rows; }
  /// Shares of the nodes around pixel (u, v); outside of the image as on its border.
  GridWeights at(double u, double v, const PinholeCamera& camera) const;
  /// Share of the image that belongs to each node; they add up to 1.
  std::vector<double> area() const;
  friend bool operator==(const ImageGrid&, const ImageGrid&) = default;
};

/// What is wrong with a depth camera, to first order, and how well that is known. With q = 1/z,
///     q_measured(u) = q_true(u + shift) - offset(u)
/// for a pixel u of the depth image: an error of disparity, smooth over the image (the model of
/// Schoeps, Sattler, Pollefeys: BAD SLAM, CVPR 2019, eq. 1, without its decay), and a shift of the
/// registered depth image against the colour image; and depth is measured by a delay later than
/// colour. A factor common to all depths is no part of
/// it: no recording can tell it from a larger world (docs/calibration.md).
struct DepthCalibration {
  PinholeCamera camera;  ///< of the registered images it was made for
  ImageGrid grid;
  std::vector<double> offset_per_m;  ///< per node of the grid; empty = none
  std::vector<double> sigma_per_m;   ///< standard deviation per node
  double mean_sigma_per_m = 0;       ///< standard deviation of the mean over the image
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d shift_sigma_px = Eigen::Vector2d::Zero();
  double delay_s = 0;  ///< of depth after colour; for who knows how the camera moves
  double delay_sigma_s = 0;

  /// Whether apply() would change nothing.
  bool corrects_nothing() const;
  /// Mean over the image, 1/m.
  double mean_offset_per_m() const;
  /// Offset of inverse depth at a pixel of the depth image, 1/m.
  double offset_at(double u, double v) const;
  /// The depth image of an ideal camera, pixel by pixel of the colour image: shifted, with the
  /// offset added to the inverse depth. Inverse depth is interpolated where all four neighbours lie
  /// on one surface and taken from the nearest elsewhere. What nothing is to be corrected of stays
  /// as it is, to the bit. The image must have the camera's size.
  DepthImage apply(const DepthImage& measured) const;

  friend bool operator==(const DepthCalibration&, const DepthCalibration&) = default;
};

}  // namespace sgs
