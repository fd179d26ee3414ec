// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/degeneracy/degeneracy_config.h"
#include "sgs/geometry/se3.h"

namespace sgs::degeneracy {

/// Quadratic model of a cost around a pose, on camera twists; the step is -H^-1 b.
struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0;
};

/// Pose prior on chosen axes, (FUSION) of docs/method.md: cost e^T W e / 2, e = log(T_prior^-1 T).
/// Chosen once per frame at the first linearisation and frozen.
struct AxisPrior {
  SE3 T_prior;                         ///< world from camera
  Matrix6d weight = Matrix6d::Zero();  ///< W = sum w_k (v_k^T Omega v_k) v_k v_k^T, or all of Omega
  unsigned mask = 0;                   ///< degenerate axes of H_icp
  bool full = false;                   ///< eta so high that all of Omega is used
};

/// `omega` is first rescaled to trace(omega) = trace(H_icp); axes are those of H_icp whose
/// condition exceeds the threshold, w = exp(-alpha (1 - eta)) or 1 with the soft gate off. All of
/// Omega is used where eta exceeds `planarity_full_prior` and an axis is degenerate, or
/// `planarity_alone` is set.
AxisPrior make_axis_prior(const Matrix6d& H_icp, const SE3& T_prior, const Matrix6d& omega,
                          double eta, const DegeneracyConfig& config);

/// Adds the prior at `T_world_camera`, residual re-evaluated, Jacobian Jr^-1(e).
void add_prior(const AxisPrior& prior, const SE3& T_world_camera, NormalEquations& equations);
/// Cost alone, for trial steps.
double prior_cost(const AxisPrior& prior, const SE3& T_world_camera);

/// What equations on camera twists say of the translation once the rotation is left free: their
/// Schur complement, with nothing about the rotation. The same minimum where it is unique.
NormalEquations translation_alone(const NormalEquations& equations);

/// `fusion = remove`, (REMOVE) of docs/method.md: H = wg G(K^T H_g K) + H_v + damping I,
/// b = wg G(K^T b_g) + b_v. K = I - P; G keeps `geometry_turn_share` of the equations as they are,
/// and of the rest what translation_alone() leaves.
NormalEquations fuse_removed(const NormalEquations& geometry, const Matrix6d& K,
                             const NormalEquations& vision, const DegeneracyConfig& config);
/// `fusion = joint`: the same without removal (K = I).
NormalEquations fuse_joint(const NormalEquations& geometry, const NormalEquations& vision,
                           const DegeneracyConfig& config);

}  // namespace sgs::degeneracy
