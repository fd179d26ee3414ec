// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Point to plane with the G-ICP noise along the normal.
//
//   r = n_b . (mu - T a),   w = 1 / (sigma_a^2 + sigma_b^2),   J = dr/dxi = [m x a ; -m],  m = R^T
//   n_b
//
// for T -> T exp(xi), xi rotation first. The default preset's residual: as accurate as full
// covariances at a fraction of the cost (Chen and Medioni 1992; G-ICP with planar ellipses in the
// limit of a vanishing floor, see gicp_factor_test).

#include <Eigen/Core>

#include "sgs/registration/linearization.h"

namespace sgs::registration {

template <class Scalar>
struct PlaneFactor {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

  Huber<Scalar> robust{Scalar(2.5)};
  Scalar reject = 10;  ///< standard deviations beyond which a pair is no inlier

  /// Robust cost of one pair; a rejected one costs what it would at the limit.
  Scalar error(const Vector3& a, Scalar variance_a, const Vector3& mu, const Vector3& n_b,
               Scalar variance_b, const Matrix3& R, const Vector3& t) const {
    using std::abs;
    using std::sqrt;
    const Scalar e = abs(n_b.dot(mu - (R * a + t))) / sqrt(variance_a + variance_b);
    return robust.cost(e < reject ? e : reject);
  }

  /// Adds one pair to `sums`.
  void linearize(const Vector3& a, Scalar variance_a, const Vector3& mu, const Vector3& n_b,
                 Scalar variance_b, const Matrix3& R, const Vector3& t,
                 ChunkSums<Scalar>& sums) const {
    using std::abs;
    using std::sqrt;
    const Scalar r = n_b.dot(mu - (R * a + t));
    const Scalar information = 1 / (variance_a + variance_b);
    const Scalar e = abs(r) * sqrt(information);
    if (!(e < reject)) {
      sums.error += robust.cost(reject);
      return;
    }
    const Vector3 m = R.transpose() * n_b;
    const Vector3 torque = m.cross(a);
    const Scalar J[6] = {torque.x(), torque.y(), torque.z(), -m.x(), -m.y(), -m.z()};
    sums.add(J, r, robust.weight(e) * information);
    sums.error += robust.cost(e);
    ++sums.inliers;
  }
};

}  // namespace sgs::registration
