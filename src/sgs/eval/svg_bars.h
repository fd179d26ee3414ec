// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
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

struct HistogramSeries {
  std::string label;
  int color = 0;  ///< palette
  Histogram histogram;
};
/// Share of the values per bin as steps, one outline per series; `log_x`: the axis shows powers of
/// ten of the binned value. "" when all are empty.
std::string histogram_svg(const std::string& title, const std::string& x_label,
                          const std::vector<HistogramSeries>& series, bool log_x, int width = 490,
                          int height = 220);

/// One horizontal bar: its length, and a whisker from there to `whisker`.
struct Bar {
  std::string label;
  double value = 0;
  double whisker = 0;     ///< drawn when larger than `value`
  std::string text;       ///< beside the bar
  int color = 0;          ///< palette
  bool indented = false;  ///< a part of the bar above
};
/// Bars from one zero line; "" without bars.
std::string bars_svg(const std::string& title, const std::string& x_label,
                     const std::vector<Bar>& bars, int width = 1000);

}  // namespace sgs::eval
