// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/eval/histogram.h"

namespace sgs::report {

struct HistogramSeries {
  std::string label;
  int color = 0;  ///< palette
  eval::Histogram histogram;
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

}  // namespace sgs::report
