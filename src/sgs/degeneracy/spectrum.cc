// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/degeneracy/spectrum.h"

#include <Eigen/Eigenvalues>
#include <limits>

#include "sgs/core/error.h"

namespace sgs::degeneracy {

double Spectrum::condition_number() const {
  return eigenvalues(0) > 0 ? eigenvalues(5) / eigenvalues(0)
                            : std::numeric_limits<double>::infinity();
}

Spectrum spectrum(const Matrix6d& information) {
  SGS_CHECK(information.allFinite(), "information matrix must be finite");
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(0.5 *
                                                       (information + information.transpose()));
  return {solver.eigenvalues(), solver.eigenvectors()};
}

unsigned condition_mask(const Spectrum& s, double tau_deg) {
  unsigned mask = 0;
  for (int k = 0; k < 6; ++k) {
    if (!(s.eigenvalues(k) > 0 && s.eigenvalues(5) <= tau_deg * s.eigenvalues(k))) mask |= 1U << k;
  }
  return mask;
}

}  // namespace sgs::degeneracy
