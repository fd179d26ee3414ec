// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/histogram.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sgs/core/error.h"

namespace sgs::eval {

Histogram::Histogram(double low, double high, int bins)
    : min(low), max(high), counts(static_cast<std::size_t>(bins), 0.0) {
  SGS_CHECK(low < high && bins > 0, "a histogram needs a range and bins");
}

void Histogram::add(double value) {
  if (!std::isfinite(value) || counts.empty()) return;
  const auto n = static_cast<double>(counts.size());
  const double bin = std::clamp(std::floor((value - min) / (max - min) * n), 0.0, n - 1);
  counts[static_cast<std::size_t>(bin)] += 1;
}

double Histogram::total() const { return std::accumulate(counts.begin(), counts.end(), 0.0); }

}  // namespace sgs::eval
