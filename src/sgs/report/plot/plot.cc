// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/report/html.h"
#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/series.h"

namespace sgs::report {
namespace {

constexpr double kPlotLeft = 66, kPlotRight = 14, kPlotTop = 10, kPlotBottom = 38, kBetween = 16,
                 kRowHeight = 17;

bool has_rows(const PlotPanel& panel) { return !panel.rows.empty(); }

double panel_height(const PlotPanel& panel) {
  return has_rows(panel) ? kRowHeight * static_cast<double>(panel.rows.size()) : panel.height;
}

/// Range of a panel's values (logarithms where asked for); empty when there is nothing to draw.
Interval value_range(const PlotPanel& panel) {
  Interval y;
  if (has_rows(panel)) {
    for (const PlotRow& row : panel.rows) {
      for (const double v : row.value) y.add(v);
    }
    return y;
  }
  for (const PlotSeries& s : panel.series) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (!std::isfinite(s.x[i]) || (panel.log_y && !(s.y[i] > 0))) continue;
      y.add(panel.log_y ? std::log10(s.y[i]) : s.y[i]);
    }
  }
  if (y.empty()) return y;
  if (panel.stacked) return {0, 1.06 * std::max(1e-9, stacked_maximum(panel.series))};
  for (const auto& [value, name] : panel.thresholds) y.add(panel.log_y ? std::log10(value) : value);
  if (panel.from_zero) y.add(0);
  const bool at_zero = panel.from_zero && y.min == 0;
  y.pad(0.06);
  if (at_zero) y.min = 0;
  if (panel.fixed_unit_y) y = {0, 1.04};
  return y;
}

Interval x_range(const std::vector<const PlotPanel*>& panels) {
  Interval x;
  for (const PlotPanel* panel : panels) {
    for (const PlotSeries& s : panel->series) {
      for (const double v : s.x) x.add(v);
    }
    for (const PlotRow& r : panel->rows) {
      for (const double v : r.x) x.add(v);
    }
  }
  if (!x.empty() && x.length() <= 0) x.pad(0.05);
  return x;
}

std::string grid_svg(const PlotPanel& panel, const PanelScale& scale,
                     const std::vector<Tick>& x_ticks) {
  std::string svg;
  for (const Tick& tick : x_ticks) {
    svg += fmt::format("<path class='grid' d='M{:.1f} {:.1f}V{:.1f}'/>", scale.u(tick.at),
                       scale.top, scale.bottom);
  }
  if (!has_rows(panel)) {
    const auto ticks =
        panel.log_y ? log_ticks(scale.y) : linear_ticks(scale.y, std::max(2, panel.height / 42));
    for (const Tick& tick : ticks) {
      const double v = scale.v_linear(tick.at);
      svg +=
          fmt::format("<path class='grid' d='M{:.1f} {:.1f}H{:.1f}'/>", scale.left, v, scale.right);
      svg += svg_text(scale.left - 6, v + 4, tick.text, TextAnchor::kEnd);
    }
  }
  if (!panel.y_label.empty()) {
    svg += fmt::format(
        "<text class='label' transform='translate(13 {:.1f}) rotate(-90)' "
        "text-anchor='middle'>{}</text>",
        0.5 * (scale.top + scale.bottom), html_escaped(panel.y_label));
  }
  return svg;
}

std::string rows_svg(const PlotPanel& panel, const PanelScale& scale) {
  std::string svg;
  double top = scale.top;
  for (const PlotRow& row : panel.rows) {
    svg += fmt::format("<rect class='row' x='{}' y='{:.1f}' width='{}' height='{}'/>", scale.left,
                       top + 2, scale.right - scale.left, kRowHeight - 3);
    svg += row_svg(row, scale, top + 2, top + kRowHeight - 1);
    svg += svg_text(scale.left - 6, top + 0.5 * kRowHeight + 4, row.label, TextAnchor::kEnd);
    top += kRowHeight;
  }
  return svg;
}

std::string panel_svg(const PlotPanel& panel, const PanelScale& scale,
                      const std::vector<Tick>& x_ticks) {
  std::string svg = grid_svg(panel, scale, x_ticks);
  if (has_rows(panel)) return svg + rows_svg(panel, scale);
  if (panel.stacked) {
    svg += stacked_svg(panel.series, scale);
  } else {
    for (const PlotSeries& s : panel.series) svg += series_svg(s, scale);
  }
  for (const auto& [value, name] : panel.thresholds) {
    const double v = scale.v(value);
    svg += fmt::format("<path class='threshold' d='M{:.1f} {:.1f}H{:.1f}'/>", scale.left, v,
                       scale.right);
    svg += svg_text(scale.right - 2, v - 4, name, TextAnchor::kEnd, "threshold-name");
  }
  return svg;
}

std::vector<LegendEntry> legend_of(const PlotFigure& figure,
                                   const std::vector<const PlotPanel*>& panels) {
  std::vector<LegendEntry> entries;
  for (const auto& [label, css_class] : figure.legend) {
    entries.push_back({label, css_class, true});
  }
  if (!entries.empty()) return entries;
  for (const PlotPanel* panel : panels) {
    if (panel->series.size() < 2) continue;
    for (const PlotSeries& s : panel->series) {
      const LegendEntry entry{s.label,
                              fmt::format("heavy c{}{}", s.color % 6, s.dashed ? " dashed" : ""),
                              panel->stacked};
      const bool known = std::any_of(entries.begin(), entries.end(), [&](const LegendEntry& e) {
        return e.label == entry.label && e.css_class == entry.css_class;
      });
      if (!known) entries.push_back(entry);
    }
  }
  return entries;
}

}  // namespace

std::string figure_svg(const PlotFigure& figure) {
  std::vector<const PlotPanel*> panels;
  for (const PlotPanel& panel : figure.panels) {
    if (!value_range(panel).empty()) panels.push_back(&panel);
  }
  const Interval x = x_range(panels);
  if (x.empty()) return {};
  const double right = figure.width - kPlotRight;
  const auto x_ticks = linear_ticks(x, std::max(2, figure.width / 100));
  std::string body;
  double top = kPlotTop;
  for (const PlotPanel* panel : panels) {
    const PanelScale scale{x,   value_range(*panel),        kPlotLeft,   right,
                           top, top + panel_height(*panel), panel->log_y};
    body += panel_svg(*panel, scale, x_ticks);
    top = scale.bottom + kBetween;
  }
  const double bottom = top - kBetween;
  const PanelScale axis{x, {0, 1}, kPlotLeft, right, kPlotTop, bottom, false};
  for (const Tick& tick : x_ticks) {
    body += svg_text(axis.u(tick.at), bottom + 15, tick.text, TextAnchor::kMiddle);
  }
  body += svg_text(0.5 * (kPlotLeft + right), bottom + 31, figure.x_label, TextAnchor::kMiddle,
                   "label");
  double height = bottom + kPlotBottom;
  body += svg_legend(legend_of(figure, panels), kPlotLeft, height + 12, right - kPlotLeft, height);
  const std::string cursor =
      figure.over_time ? fmt::format("class='time' data-axis='{:g} {:g} {:g} {:g} {:g} {:g}'",
                                     x.min, x.max, kPlotLeft, right, kPlotTop, bottom)
                       : "";
  return svg_open(figure.width, height, figure.title, cursor) + body + "</svg>";
}

}  // namespace sgs::report
