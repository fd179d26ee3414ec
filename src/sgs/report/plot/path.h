// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace sgs::report {

/// A path in the plane. With `value` (same length, NaN allowed) its pieces take the colour of the
/// sequential scale, else the palette's `color`.
struct PlanePath {
  std::string label;
  int color = 0;
  std::vector<double> x, y;
  std::vector<double> value;
  bool band = false;  ///< wide and pale, for what others are compared with
  bool ends = true;   ///< a ring at the start, a disc at the end
};

struct PlaneFigure {
  std::string title;  ///< for screen readers
  std::string x_label, y_label;
  std::vector<PlanePath> paths;
  std::string value_label;  ///< of the colour bar; no bar when empty
  double value_max = 0;     ///< colour scale 0 .. value_max
  int width = 490, height = 400;
};

/// Paths with one scale for both axes as one <svg> element; "" without points.
std::string plane_svg(const PlaneFigure& figure);

}  // namespace sgs::report
