// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sgs/report/plot/plot.h"
#include "sgs/report/plot/scale.h"

namespace sgs::report {

/// Maps data to the coordinates of one panel's rectangle.
struct PanelScale {
  Interval x, y;  ///< y in decimal logarithms where `log_y`
  double left = 0, right = 0, top = 0, bottom = 0;
  bool log_y = false;

  double u(double value) const { return left + (value - x.min) / x.length() * (right - left); }
  double v_linear(double value) const {
    return bottom - (value - y.min) / y.length() * (bottom - top);
  }
  double v(double value) const;
  bool drawable(double xv, double yv) const;
};

/// The series as <path>.
std::string series_svg(const PlotSeries& series, const PanelScale& scale);
/// Areas on top of each other, averaged over at most some hundred stretches of x.
std::string stacked_svg(const std::vector<PlotSeries>& series, const PanelScale& scale);
/// Largest sum of a stack, averaged in the same way.
double stacked_maximum(const std::vector<PlotSeries>& series);
/// The row as rectangles between `top` and `bottom`, equal neighbours joined.
std::string row_svg(const PlotRow& row, const PanelScale& scale, double top, double bottom);

}  // namespace sgs::report
