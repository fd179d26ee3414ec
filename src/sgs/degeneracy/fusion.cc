// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/degeneracy/fusion.h"

#include "sgs/degeneracy/planarity.h"
#include "sgs/degeneracy/spectrum.h"

namespace sgs::degeneracy {

AxisPrior make_axis_prior(const Matrix6d& H_icp, const SE3& T_prior, const Matrix6d& omega,
                          double eta, const DegeneracyConfig& config) {
  AxisPrior prior;
  prior.T_prior = T_prior;
  const Spectrum s = spectrum(H_icp);
  prior.mask = condition_mask(s, config.condition_threshold);
  const double trace = omega.trace();
  const bool planar = eta > config.planarity_full_prior;
  if (!(trace > 0) || (prior.mask == 0 && !(planar && config.planarity_alone))) return prior;
  const Matrix6d scaled = omega * (H_icp.trace() / trace);
  prior.full = planar;
  if (prior.full) {
    prior.weight = 0.5 * (scaled + scaled.transpose());
    return prior;
  }
  const double w = config.soft_gate ? planarity_gate(eta, config.planarity_alpha) : 1.0;
  for (int k = 0; k < 6; ++k) {
    if ((prior.mask >> k & 1U) == 0) continue;
    const Vector6d v = s.axes.col(k);
    prior.weight += w * v.dot(scaled * v) * v * v.transpose();
  }
  return prior;
}

void add_prior(const AxisPrior& prior, const SE3& T_world_camera, NormalEquations& equations) {
  const Vector6d e = (prior.T_prior.inverse() * T_world_camera).log();
  const Matrix6d J = se3_right_jacobian_inverse(e);
  equations.H += J.transpose() * prior.weight * J;
  equations.b += J.transpose() * (prior.weight * e);
  equations.cost += 0.5 * e.dot(prior.weight * e);
}

double prior_cost(const AxisPrior& prior, const SE3& T_world_camera) {
  const Vector6d e = (prior.T_prior.inverse() * T_world_camera).log();
  return 0.5 * e.dot(prior.weight * e);
}

NormalEquations translation_alone(const NormalEquations& equations) {
  // Rotations that the equations do not see are not inverted.
  constexpr double kUnseen = 1e-6;
  NormalEquations out;
  out.cost = equations.cost;
  Eigen::Matrix3d H_turn = equations.H.topLeftCorner<3, 3>();
  H_turn.diagonal().array() += kUnseen * H_turn.trace();
  if (!(H_turn.trace() > 0)) return out;
  const Eigen::Matrix3d G = equations.H.bottomLeftCorner<3, 3>() * H_turn.inverse();
  const Eigen::Matrix3d H =
      equations.H.bottomRightCorner<3, 3>() - G * equations.H.topRightCorner<3, 3>();
  out.H.bottomRightCorner<3, 3>() = 0.5 * (H + H.transpose());
  out.b.tail<3>() = equations.b.tail<3>() - G * equations.b.head<3>();
  return out;
}

NormalEquations fuse_removed(const NormalEquations& geometry, const Matrix6d& K,
                             const NormalEquations& vision, const DegeneracyConfig& config) {
  const double wg = config.geometry_weight;
  const NormalEquations seen{K.transpose() * geometry.H * K, K.transpose() * geometry.b, 0};
  const NormalEquations place = translation_alone(seen);
  const double turns = wg * config.geometry_turn_share;
  const double only_moves = wg - turns;
  NormalEquations out;
  out.H = turns * seen.H + only_moves * place.H + vision.H;
  out.H.diagonal().array() += config.damping;
  out.b = turns * seen.b + only_moves * place.b + vision.b;
  out.cost = wg * geometry.cost + vision.cost;
  return out;
}

NormalEquations fuse_joint(const NormalEquations& geometry, const NormalEquations& vision,
                           const DegeneracyConfig& config) {
  return fuse_removed(geometry, Matrix6d::Identity(), vision, config);
}

}  // namespace sgs::degeneracy
