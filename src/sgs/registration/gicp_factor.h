// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// G-ICP (Segal, Haehnel, Thrun, RSS 2009; the paper's Eq. 1-3).
//
//   d = mu - T a,   Sigma = C_b + R C_a R^T,   J = dd/dxi = [R [a]x, -R],
//   H = J^T Sigma^-1 J,   b = J^T Sigma^-1 d
//
// for T -> T exp(xi), xi rotation first. Computed in the camera frame, where J becomes [[a]x, -I]
// and Sigma becomes R^T C_b R + C_a: the same numbers for less work. Sigma is held fixed within an
// iteration.

#include <Eigen/Core>
#include <Eigen/LU>

#include "sgs/registration/linearization.h"

namespace sgs::registration {

template <class Scalar>
struct GicpFactor {
  using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
  using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;

  Huber<Scalar> robust{Scalar(1.345)};  ///< on the Mahalanobis distance
  Scalar reject = Scalar(1e9);          ///< Mahalanobis distance beyond which a pair is no inlier

  /// Robust cost of one pair; a rejected one costs what it would at the limit.
  Scalar error(const Vector3& a, const Matrix3& C_a, const Vector3& mu, const Matrix3& C_b,
               const Matrix3& R, const Vector3& t) const {
    const Vector3 d = R.transpose() * (mu - t) - a;
    const Scalar e = mahalanobis(d, information(C_a, C_b, R));
    return robust.cost(e < reject ? e : reject);
  }

  /// Adds one pair to `sums`.
  void linearize(const Vector3& a, const Matrix3& C_a, const Vector3& mu, const Matrix3& C_b,
                 const Matrix3& R, const Vector3& t, ChunkSums<Scalar>& sums) const {
    const Vector3 d = R.transpose() * (mu - t) - a;
    Matrix3 W = information(C_a, C_b, R);
    const Scalar e = mahalanobis(d, W);
    if (!(e < reject)) {
      sums.error += robust.cost(reject);
      return;
    }
    W *= robust.weight(e);
    Matrix3 A;  // [a]x
    A << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    const Matrix3 WA = W * A;
    const Matrix3 H_rr = A.transpose() * WA;
    const Vector3 Wd = W * d;
    const Vector3 b_r = A.transpose() * Wd;
    int q = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) sums.H[q++] += H_rr(i, j);
      for (int j = 0; j < 3; ++j) sums.H[q++] -= WA(j, i);
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) sums.H[q++] += W(i, j);
    }
    for (int i = 0; i < 3; ++i) {
      sums.b[i] += b_r[i];
      sums.b[i + 3] -= Wd[i];
    }
    sums.error += robust.cost(e);
    ++sums.inliers;
  }

 private:
  static Matrix3 information(const Matrix3& C_a, const Matrix3& C_b, const Matrix3& R) {
    const Matrix3 sigma = R.transpose() * C_b * R + C_a;
    return sigma.inverse();
  }
  static Scalar mahalanobis(const Vector3& d, const Matrix3& W) {
    using std::sqrt;
    const Scalar e2 = d.dot(W * d);
    return e2 > 0 ? sqrt(e2) : Scalar(0);
  }
};

}  // namespace sgs::registration
