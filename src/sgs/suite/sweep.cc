// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/suite/sweep.h"

#include <algorithm>
#include <cmath>
#include <regex>

#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/plot.h"

namespace sgs::suite {
namespace {

/// Mean trajectory error in cm; NaN where no run has one.
double mean_cm(std::span<const eval::Metrics> runs) {
  double sum = 0;
  for (const eval::Metrics& m : runs) sum += 100 * m.ate_rmse_m.value_or(NAN);
  return sum / static_cast<double>(runs.size());
}

}  // namespace

Result<Range> parse_range(const std::string& text, int per_octave,
                          const std::map<std::string, std::string>& aliases) {
  static const std::regex form(R"(([A-Za-z0-9_.]+)=([0-9.eE+-]+):([0-9.eE+-]+))");
  std::smatch match;
  const auto wrong = [&] {
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}' is no range", text),
                "write KEY=A:B with 0 < A <= B, e.g. tau_deg=25:3200");
  };
  if (!std::regex_match(text, match, form)) return wrong();
  const double from = std::strtod(match[2].str().c_str(), nullptr);
  const double to = std::strtod(match[3].str().c_str(), nullptr);
  if (!(from > 0) || !(to >= from) || !std::isfinite(to)) return wrong();
  const auto alias = aliases.find(match[1]);
  Range range{alias == aliases.end() ? match[1].str() : alias->second, {from}};
  if (to == from) return range;
  const int steps = std::max(1, static_cast<int>(std::lround(std::log2(to / from) * per_octave)));
  for (int i = 1; i <= steps; ++i) {
    range.values.push_back(from * std::pow(to / from, static_cast<double>(i) / steps));
  }
  return range;
}

std::vector<Variant> swept_variants(const Variant& base, const Range& range) {
  std::vector<Variant> variants;
  for (const double value : range.values) {
    Variant& variant = variants.emplace_back(base);
    variant.name = fmt::format("{:.6g}", value);
    variant.arguments.insert(variant.arguments.end(),
                             {"--set", fmt::format("{}={}", range.key, variant.name)});
  }
  return variants;
}

std::string sweep_plot(const Grid& grid, const std::string& key) {
  constexpr int kColors = 6;
  report::PlotPanel panel;
  panel.y_label = "ATE RMSE, cm";
  panel.log_y = true;
  panel.height = 300;
  for (std::size_t c = 0; c < grid.columns.size(); ++c) {
    report::PlotSeries series;
    series.label = grid.columns[c];
    series.color = static_cast<int>(c) % kColors;
    series.dashed = c >= kColors;
    for (const std::string& value : grid.rows) {
      series.x.push_back(std::log2(std::strtod(value.c_str(), nullptr)));
      series.y.push_back(mean_cm(grid.at(value, grid.columns[c])));
    }
    panel.series.push_back(std::move(series));
  }
  report::PlotFigure figure;
  figure.title = "Trajectory error over " + key;
  figure.x_label = "log2 of " + key;
  figure.panels = {std::move(panel)};
  figure.over_time = false;
  const std::string svg = report::figure_svg(figure);
  return svg.empty() ? svg : report::standalone_svg({"sweep", "", svg});
}

}  // namespace sgs::suite
