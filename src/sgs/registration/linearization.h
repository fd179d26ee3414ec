// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/se3.h"

namespace sgs::registration {

/// Second-order model of a cost about a pose: cost(T exp(xi)) ~ error + 2 b.xi + xi.H xi. Twists
/// are rotation first and perturb on the right, so H and b live in the camera frame and do not
/// depend on where the world's origin is.
struct Linearization {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double error = 0;  ///< robust cost
  int inliers = 0;   ///< terms that contribute

  Linearization& operator+=(const Linearization& other) {
    H += other.H;
    b += other.b;
    error += other.error;
    inliers += other.inliers;
    return *this;
  }
};

/// Upper triangle of H, b and cost of up to a few hundred terms; in float for speed. Chunks of a
/// fixed size are summed in float and added up in double, so that the result has double's accuracy
/// where it matters and does not depend on who computes which chunk.
template <class Scalar>
struct ChunkSums {
  Scalar H[21] = {};
  Scalar b[6] = {};
  Scalar error = 0;
  int inliers = 0;

  /// Adds the scalar residual `r` with Jacobian `J` (6) and weight `w`.
  template <class Vector>
  void add(const Vector& J, Scalar r, Scalar w) {
    int q = 0;
    for (int i = 0; i < 6; ++i) {
      const Scalar wj = w * J[i];
      b[i] += wj * r;
      for (int j = i; j < 6; ++j) H[q++] += wj * J[j];
    }
  }
  void flush_into(Linearization& total) {
    int q = 0;
    for (int i = 0; i < 6; ++i) {
      total.b[i] += static_cast<double>(b[i]);
      for (int j = i; j < 6; ++j, ++q) {
        total.H(i, j) += static_cast<double>(H[q]);
        if (i != j) total.H(j, i) += static_cast<double>(H[q]);
      }
    }
    total.error += static_cast<double>(error);
    total.inliers += inliers;
    *this = {};
  }
};

/// Huber's robust cost of a residual of `e` >= 0 standard deviations.
template <class Scalar>
struct Huber {
  Scalar k;
  Scalar cost(Scalar e) const { return e <= k ? e * e : 2 * k * e - k * k; }
  Scalar weight(Scalar e) const { return e <= k ? Scalar(1) : k / e; }
};

}  // namespace sgs::registration
