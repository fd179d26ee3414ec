// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sgs::eval {

/// One line of a plot; NaN in x or y interrupts it.
struct PlotSeries {
  std::string label;
  int color = 0;  ///< 0..5: the page's palette (CSS classes c0..c5)
  std::vector<double> x, y;
  bool dashed = false;
  bool filled = false;  ///< area down to the bottom instead of a line
};

struct PlotOptions {
  std::string x_label, y_label;
  bool log_y = false;                                      ///< values <= 0 are missing
  bool equal_axes = false;                                 ///< one metre is as long in x as in y
  bool from_zero = false;                                  ///< y starts at 0
  bool fixed_unit_y = false;                               ///< y is 0..1
  std::vector<std::pair<double, std::string>> thresholds;  ///< horizontal dashed lines with a name
  int width = 1000, height = 240;
};

/// Inline SVG with axes, grid, legend (for two lines or more); "" when there is nothing to draw.
/// Long lines are thinned to what can be seen, keeping their extremes.
std::string plot_svg(const std::vector<PlotSeries>& series, const PlotOptions& options);

/// Coloured strip over time: one CSS class name per value; equal neighbours are joined.
std::string strip_svg(const std::vector<double>& x, const std::vector<double>& value,
                      const std::vector<std::string>& classes, int width = 1000, int height = 30);

}  // namespace sgs::eval
