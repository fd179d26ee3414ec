// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sgs/backend/bundle_rows.h"

namespace sgs::backend {

/// Doubles per keyframe in these sums: its unknowns and a zero, so that vectors end with it.
inline constexpr std::size_t kBlockStride = 12;
/// Unknowns of the calibration that one depth touches: four nodes of the grid, shift, delay.
inline constexpr std::size_t kTouchedCalibration = 7;

/// A residual of one pixel with its weight. Blocks count keyframes as seen from the pixel's own:
/// that one is 0, its n-th target n.
struct WeightedRow {
  std::size_t block = 0;
  double weight = 0, residual = 0, by_inverse_depth = 0;
  std::array<double, kBlockStride> by_host{}, by_target{};  ///< zero where the block is 0
  bool is_depth = false;
  std::array<std::size_t, kTouchedCalibration> calibration{};  ///< which unknowns; depth only
  std::array<double, kTouchedCalibration> by_calibration{};
};

/// How an eliminated inverse depth d follows the other unknowns x: H d = -b - coupling . x
struct Elimination {
  double H = 0, b = 0;
  std::vector<std::size_t> blocks;       ///< that see the pixel, its own first
  std::vector<std::size_t> calibration;  ///< unknowns of the calibration
  std::vector<double> coupling;          ///< kBlockStride per block, then one per unknown
};

/// Normal equations of a bundle adjustment, summed keyframe by keyframe in a dense corner of their
/// own that fits the cache. Sequential; same bits for the same instruction set.
class BundleSums {
 public:
  explicit BundleSums(std::size_t calibration_unknowns);

  /// Empties all sums and keeps their memory: the sums of one linearization begin here.
  void begin();
  /// Empties the sums of keyframes. `blocks`: the keyframe and its targets.
  void begin_host(std::size_t blocks);
  /// Adds the rows of a pixel with its inverse depth eliminated, and tells how that follows.
  void add_pixel(std::span<const WeightedRow> rows, Elimination& elimination);

  /// Sums of a pair of blocks, a <= b.
  Eigen::Matrix<double, kKeyframeUnknowns, kKeyframeUnknowns> H(std::size_t a, std::size_t b) const;
  KeyframeVector b(std::size_t block) const;
  /// Of a block and an unknown of the calibration.
  KeyframeVector cross(std::size_t block, std::size_t unknown) const;
  /// Of the calibration, over all keyframes so far; upper triangle.
  const Eigen::MatrixXd& calibration_H() const { return calibration_H_; }
  const Eigen::VectorXd& calibration_b() const { return calibration_b_; }

 private:
  void start_elimination(std::span<const WeightedRow> rows, Elimination& e);
  void add_calibration(std::span<const WeightedRow> rows, Elimination& e);

  std::size_t width_ = 0;  // doubles per row of the sums of keyframes
  std::vector<double> H_, b_, cross_;
  Eigen::MatrixXd calibration_H_;
  Eigen::VectorXd calibration_b_;
  std::vector<std::size_t> place_;  // of an unknown in the elimination at hand
};

}  // namespace sgs::backend
