// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sgs::report {

/// One line of a plot; NaN in x or y interrupts it.
struct PlotSeries {
  std::string label;
  int color = 0;  ///< 0..5: the palette (CSS classes c0..c5)
  std::vector<double> x, y;
  bool dashed = false;
  bool filled = false;  ///< area down to the bottom instead of a line
};

/// One coloured row over x: a class per value, or a shade of one colour for values 0..1.
struct PlotRow {
  std::string label;
  std::vector<double> x, value;      ///< NaN: left blank
  std::vector<std::string> classes;  ///< CSS class of value 0, 1, ..., "" = blank; empty: shades
};

/// One of the plots that share an x axis. It holds lines, or rows.
struct PlotPanel {
  std::string y_label;
  std::vector<PlotSeries> series;
  std::vector<PlotRow> rows;
  bool log_y = false;         ///< values <= 0 are missing
  bool from_zero = false;     ///< y starts at 0
  bool fixed_unit_y = false;  ///< y is 0..1
  bool stacked = false;       ///< series are areas on top of each other; NaN counts as 0
  std::vector<std::pair<double, std::string>> thresholds;  ///< horizontal dashed lines with a name
  int height = 180;  ///< of the plotting area; rows take what they need
};

/// Panels on top of each other over one x axis.
struct PlotFigure {
  std::string title;  ///< for screen readers
  std::string x_label;
  std::vector<PlotPanel> panels;
  /// Below the panels; empty: one entry per labelled series where a panel has two or more.
  std::vector<std::pair<std::string, std::string>> legend;  ///< label, CSS class
  int width = 1000;
  bool over_time = true;  ///< the page's time cursor runs through it
};

/// The figure as one <svg> element; "" when no panel has anything to draw (panels without data are
/// left out). Long lines are thinned to what can be seen, keeping their extremes.
std::string figure_svg(const PlotFigure& figure);

}  // namespace sgs::report
