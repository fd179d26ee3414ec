// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace sgs::report {

/// Closed interval that grows over the values added to it; empty at first.
struct Interval {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(min <= max); }
  double length() const { return max - min; }
  /// Values that are not finite are ignored.
  void add(double v);
  /// Grows both ends by a share of the length (of the value where there is no length).
  void pad(double share);
};

/// One mark of an axis.
struct Tick {
  double at = 0;  ///< in the units of the interval (the decimal logarithm for log_ticks)
  std::string text;
};
/// About `count` round positions (1, 2 or 5 times a power of ten) within the interval.
std::vector<Tick> linear_ticks(const Interval& interval, int count);
/// Powers of ten within an interval of decimal logarithms, at most about six; 1, 2 and 5 times
/// powers of ten where the interval is short.
std::vector<Tick> log_ticks(const Interval& interval);

/// A number for reading: up to `digits` significant digits, no needless zeros.
std::string short_number(double value, int digits = 3);

}  // namespace sgs::report
