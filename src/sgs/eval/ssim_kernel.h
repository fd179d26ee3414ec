// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace sgs::eval {

inline constexpr int kSsimRadius = 5;
inline constexpr int kSsimWindow = 2 * kSsimRadius + 1;
/// Doubles that must be readable behind the end of each array below.
inline constexpr std::size_t kSsimPadding = 16;

/// One channel of two pictures, and room for its moments.
struct SsimJob {
  const double* x = nullptr;
  const double* y = nullptr;
  std::size_t width = 0, height = 0;  ///< at least kSsimWindow each
  const double* weight = nullptr;     ///< kSsimWindow of them
  double* moments[5] = {};            ///< width each: of x, y, x^2, y^2, xy
};

/// Sum of the SSIM map over the interior (Wang et al. 2004, eq. 13). In double, as small variances
/// are differences of large moments.
double ssim_sum(const SsimJob& job);

}  // namespace sgs::eval
