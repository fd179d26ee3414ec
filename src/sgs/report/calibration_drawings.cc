// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/report/drawings.h"

namespace sgs::report {
namespace {

constexpr double kPerKilometre = 1e3;  // 1/m in 1/km

/// The values of the nodes as an image in colour steps from `low` to `high`, 1/km.
std::string grid_svg(const DepthCalibration& c, const std::vector<double>& per_km, double low,
                     double high, const std::string& title) {
  constexpr double kWidth = 420, kLegendTop = 16, kRow = 17;
  const double cell = kWidth / c.grid.columns;
  const double cell_height =
      cell * c.camera.height * c.grid.columns / (static_cast<double>(c.camera.width) * c.grid.rows);
  const double height = cell_height * c.grid.rows;
  const auto step = [&](int node) {
    return heat_step((per_km[static_cast<std::size_t>(node)] - low) / (high - low));
  };
  std::string cells;
  for (int y = 0; y < c.grid.rows; ++y) {
    for (int x = 0; x < c.grid.columns;) {
      const int first = x, colour = step(y * c.grid.columns + x);
      while (x < c.grid.columns && step(y * c.grid.columns + x) == colour) ++x;
      cells += fmt::format(
          "<rect class='bar h{}' x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}'/>", colour,
          first * cell, y * cell_height, (x - first) * cell + 0.3, cell_height + 0.3);
    }
  }
  std::vector<LegendEntry> legend;
  for (const int k : {0, kHeatSteps / 2, kHeatSteps - 1}) {
    const double value = low + (high - low) * k / (kHeatSteps - 1);
    const std::string text = low < 0 ? fmt::format("{:+.1f}", value) : fmt::format("{:.1f}", value);
    legend.push_back({text + " /km", fmt::format("h{}", k), true});
  }
  double used = 0;
  const std::string scale = svg_legend(legend, 0, height + kLegendTop, kWidth, used);
  return svg_open(kWidth, height + kLegendTop + std::max(used, kRow), title) + cells + scale +
         "</svg>";
}

std::vector<double> in_per_km(const std::vector<double>& per_m) {
  std::vector<double> out;
  for (const double value : per_m) out.push_back(kPerKilometre * value);
  return out;
}

}  // namespace

std::vector<Drawing> calibration_drawings(const ReportData& data) {
  if (!data.calibration || data.calibration->offset_per_m.empty()) return {};
  const DepthCalibration& c = *data.calibration;
  const std::vector<double> offsets = in_per_km(c.offset_per_m);
  const std::vector<double> sigmas = in_per_km(c.sigma_per_m);
  constexpr double kLeast = 0.1;  // 1/km: so that a calibration of nothing is no division by zero
  double most = kLeast;
  for (const double offset : offsets) most = std::max(most, std::abs(offset));
  const double widest = std::max(kLeast, *std::max_element(sigmas.begin(), sigmas.end()));
  return {
      {"depth_offset",
       fmt::format("What was added to the inverse depths, over the image (mean {:+.2f} ± {:.2f} "
                   "/km; 1 /km moves a surface at 2 m by 4 mm). Depth lay {:+.2f}, {:+.2f} px "
                   "(± {:.2f}, {:.2f}) beside colour and came {:+.1f} ms (± {:.1f}) after it.",
                   kPerKilometre * c.mean_offset_per_m(), kPerKilometre * c.mean_sigma_per_m,
                   c.shift_px.x(), c.shift_px.y(), c.shift_sigma_px.x(), c.shift_sigma_px.y(),
                   1e3 * c.delay_s, 1e3 * c.delay_sigma_s),
       grid_svg(c, offsets, -most, most, "Offset of inverse depth over the image")},
      {"depth_offset_sigma", "Standard deviation of these offsets.",
       grid_svg(c, sigmas, 0, widest, "Standard deviation of the offset over the image")}};
}

}  // namespace sgs::report
