// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace sgs::eval {

/// Counts of values in bins of equal width over [min, max]; what lies outside counts in the outer
/// bins.
struct Histogram {
  double min = 0, max = 1;
  std::vector<double> counts;

  Histogram() = default;
  Histogram(double low, double high, int bins);
  void add(double value);  ///< not finite: ignored
  double total() const;
};

}  // namespace sgs::eval
