// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/se3.h"

namespace sgs::degeneracy {

/// Eigen-decomposition of a symmetric 6x6 information matrix.
struct Spectrum {
  Vector6d eigenvalues = Vector6d::Zero();  ///< rising
  Matrix6d axes = Matrix6d::Identity();     ///< column k belongs to eigenvalue k
  /// lambda_max / lambda_min; infinite where lambda_min <= 0.
  double condition_number() const;
};

/// Only the symmetric part of `information` is used.
Spectrum spectrum(const Matrix6d& information);

/// Bit k set where lambda_max / lambda_k > `tau_deg` or lambda_k <= 0 (the paper's test). A matrix
/// without any positive eigenvalue is degenerate in all axes.
unsigned condition_mask(const Spectrum& spectrum, double tau_deg);

}  // namespace sgs::degeneracy
