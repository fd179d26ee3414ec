// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sgs/backend/bundle_problem.h"

namespace sgs::backend {

/// Unknowns of a keyframe: twist (right perturbation, rotation first), log gain, brightness offset,
/// turn during the readout.
inline constexpr int kKeyframeUnknowns = 11;
using KeyframeVector = Eigen::Matrix<double, kKeyframeUnknowns, 1>;

/// A pixel as its own keyframe sees it, at one level of the pyramid.
struct HostPoint {
  int host = 0;
  double grey = 0;
  double row_offset = 0;  ///< place of its row in the readout, -0.5 .. 0.5
  Eigen::Vector3d X;      ///< in the middle row's camera, m
  Eigen::Vector3d dX;     ///< by the inverse depth
};

/// One residual and its derivatives.
struct BundleRow {
  int target = 0;  ///< keyframe in which the pixel was looked for; may be its own
  bool is_depth = false;
  double residual = 0;  ///< grey or 1/m
  double sigma = 1;     ///< of the noise, in units of BundleNoise
  double by_inverse_depth = 0;
  KeyframeVector by_host = KeyframeVector::Zero(), by_target = KeyframeVector::Zero();
  GridWeights grid{};  ///< derivatives by the offsets; depth only
  Eigen::Vector3d by_shift_and_delay = Eigen::Vector3d::Zero();
};

/// The residuals of a bundle adjustment at a state of its unknowns. For a pixel with inverse depth
/// rho of keyframe i, seen at X in keyframe j,
///     r_grey  = I_j(pi(X)) - o_j - exp(a_j - a_i) (I_i - o_i)
///     r_depth = q_j(pi(X) - shift) + offset(pi(X) - shift) - 1 / X_z
/// with j = i among the depths. Pictures are seen, and depths measured, row by row as the rolling
/// shutter reads them, depths by the delay later. Both arguments must outlive it.
class BundleRows {
 public:
  BundleRows(const BundleProblem& problem, const BundleState& state);

  /// Empty where the pixel lies on the level's border.
  std::optional<HostPoint> point(int host, std::size_t pixel, int level) const;
  /// False where the point lies outside of the target's picture.
  bool grey(const HostPoint& point, int target, int level, BundleRow& row) const;
  /// False where the target measures no surface, or another one than the point's.
  bool depth(const HostPoint& point, int target, BundleRow& row) const;

 private:
  SE3 relative(int target, int host) const;
  const Vector6d& readout(int keyframe) const;

  const BundleProblem& problem_;
  const BundleState& state_;
  // Per keyframe.
  std::vector<SE3> T_camera_world_;
  std::vector<Vector6d> readout_;  // camera twist over the readout
};

}  // namespace sgs::backend
