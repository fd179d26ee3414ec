// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/exposure_curve.h"

#include <algorithm>

namespace sgs::refine {

std::array<float, 3> ExposureCurve::at(double timestamp_s) const {
  if (exposures_.empty()) return {1, 1, 1};
  const auto after = std::lower_bound(
      exposures_.begin(), exposures_.end(), timestamp_s,
      [](const Exposure& exposure, double time_s) { return exposure.timestamp_s < time_s; });
  if (after == exposures_.begin()) return after->gain;
  if (after == exposures_.end()) return exposures_.back().gain;
  const Exposure &a = *(after - 1), &b = *after;
  const auto share =
      static_cast<float>((timestamp_s - a.timestamp_s) / (b.timestamp_s - a.timestamp_s));
  std::array<float, 3> gain;
  for (std::size_t c = 0; c < 3; ++c) gain[c] = a.gain[c] + share * (b.gain[c] - a.gain[c]);
  return gain;
}

}  // namespace sgs::refine
