// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/descent.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>

#include "sgs/core/log.h"

namespace sgs::backend {
namespace {

/// None where the equations have no solution. Their H is lost.
std::optional<Eigen::VectorXd> newton_step(BundleEquations& equations) {
  // In its own place.
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper> factors(equations.H);
  if (factors.info() != Eigen::Success) return {};
  Eigen::VectorXd step = -factors.solve(equations.b);
  if (!step.allFinite()) return {};
  return step;
}

}  // namespace

bool descend(Bundle& bundle, int level, int steps, BundleNoise& noise) {
  constexpr double kConverged = 0.05;
  constexpr BundleNoise kLeast{1, 0.1};
  for (int k = 0; k < steps; ++k) {
    BundleEquations equations = bundle.linearize(level, noise);
    noise.grey = std::max(kLeast.grey, equations.measured.grey);
    noise.depth = std::max(kLeast.depth, equations.measured.depth);
    const auto step = newton_step(equations);
    if (!step) return false;
    bundle.apply(*step);
    log().debug(
        "bundle: level {} step {}: cost {:.1f}, {} + {} residuals, grey {:.2f}, depth {:.2f}, "
        "mean offset {:.5f} /m, shift {:.2f} {:.2f} px, delay {:.4f} s",
        level, k, equations.cost, equations.grey_residuals, equations.depth_residuals, noise.grey,
        noise.depth, bundle.state().offsets_per_m.mean(), bundle.state().shift_px.x(),
        bundle.state().shift_px.y(), bundle.state().delay_s);
    const bool converged = -0.5 * equations.b.dot(*step) < kConverged;
    bundle.reuse(std::move(equations));
    if (converged) break;
  }
  return true;
}

}  // namespace sgs::backend
