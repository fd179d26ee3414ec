// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/report/html.h"
#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/series.h"

namespace sgs::report {
namespace {

constexpr double kPathLeft = 58, kPathRight = 14, kPathTop = 10, kPathBottom = 38, kBarWidth = 68;
constexpr std::size_t kMaxPathPoints = 2500;

/// Widens the shorter axis until both have the same scale.
void equalise(PanelScale& s) {
  const double w = s.right - s.left, h = s.bottom - s.top;
  const double scale = std::max(s.x.length() / w, s.y.length() / h);
  const double grow_x = 0.5 * (scale * w - s.x.length()), grow_y = 0.5 * (scale * h - s.y.length());
  s.x.min -= grow_x;
  s.x.max += grow_x;
  s.y.min -= grow_y;
  s.y.max += grow_y;
}

/// Pieces of equal colour; -1 is the path's own colour.
std::string path_svg(const PlanePath& path, const PanelScale& scale, double value_max) {
  const std::size_t n = std::min(path.x.size(), path.y.size());
  const std::size_t step = std::max<std::size_t>(1, n / kMaxPathPoints);
  const auto step_of = [&](std::size_t i) {
    if (path.value.size() != n || value_max <= 0 || !std::isfinite(path.value[i])) return -1;
    return heat_step(path.value[i] / value_max);
  };
  std::string svg, piece, last_point;
  int piece_step = -1;
  const auto flush = [&] {
    if (!piece.empty()) {
      svg += fmt::format("<path class='line {}{}{}' d='{}'/>", piece_step < 0 ? "c" : "h",
                         piece_step < 0 ? path.color % 6 : piece_step,
                         path.band        ? " band"
                         : piece_step < 0 ? ""
                                          : " heavy",
                         piece);
    }
    piece.clear();
  };
  for (std::size_t i = 0; i < n; i += step) {
    if (!scale.drawable(path.x[i], path.y[i])) {
      flush();
      last_point.clear();
      continue;
    }
    const std::string point = fmt::format("{:.1f} {:.1f}", scale.u(path.x[i]), scale.v(path.y[i]));
    if (piece.empty() || step_of(i) != piece_step) {
      flush();
      piece_step = step_of(i);
      piece = last_point.empty() ? "M" + point + "h0" : "M" + last_point + "L" + point;
    } else {
      piece += "L" + point;
    }
    last_point = point;
  }
  flush();
  return svg;
}

std::string ends_svg(const PlanePath& path, const PanelScale& scale) {
  if (!path.ends || path.x.empty() || !scale.drawable(path.x.front(), path.y.front()) ||
      !scale.drawable(path.x.back(), path.y.back())) {
    return {};
  }
  return fmt::format(
      "<circle class='line c5' cx='{:.1f}' cy='{:.1f}' r='5'><title>start</title></circle>"
      "<circle class='bar c5' cx='{:.1f}' cy='{:.1f}' r='4'><title>end</title></circle>",
      scale.u(path.x.front()), scale.v(path.y.front()), scale.u(path.x.back()),
      scale.v(path.y.back()));
}

std::string axes_svg(const PlaneFigure& figure, const PanelScale& s) {
  std::string svg;
  for (const Tick& t : linear_ticks(s.x, static_cast<int>((s.right - s.left) / 75))) {
    svg +=
        fmt::format("<path class='grid' d='M{:.1f} {:.1f}V{:.1f}'/>", s.u(t.at), s.top, s.bottom);
    svg += svg_text(s.u(t.at), s.bottom + 15, t.text, TextAnchor::kMiddle);
  }
  for (const Tick& t : linear_ticks(s.y, static_cast<int>((s.bottom - s.top) / 55))) {
    svg +=
        fmt::format("<path class='grid' d='M{:.1f} {:.1f}H{:.1f}'/>", s.left, s.v(t.at), s.right);
    svg += svg_text(s.left - 6, s.v(t.at) + 4, t.text, TextAnchor::kEnd);
  }
  svg += svg_text(0.5 * (s.left + s.right), s.bottom + 31, figure.x_label, TextAnchor::kMiddle,
                  "label");
  return svg + fmt::format(
                   "<text class='label' transform='translate(13 {:.1f}) rotate(-90)' "
                   "text-anchor='middle'>{}</text>",
                   0.5 * (s.top + s.bottom), html_escaped(figure.y_label));
}

std::string color_bar_svg(const PlaneFigure& figure, double left, double top, double bottom) {
  const double h = (bottom - top) / kHeatSteps;
  std::string svg;
  for (int k = 0; k < kHeatSteps; ++k) {
    svg += fmt::format("<rect class='bar h{}' x='{:.1f}' y='{:.1f}' width='11' height='{:.1f}'/>",
                       k, left, bottom - (k + 1) * h, h + 0.3);
  }
  for (const Tick& t : linear_ticks({0, figure.value_max}, 4)) {
    svg += svg_text(left + 15, bottom - t.at / figure.value_max * (bottom - top) + 4, t.text,
                    TextAnchor::kStart);
  }
  return svg + fmt::format(
                   "<text class='label' transform='translate({:.1f} {:.1f}) rotate(-90)' "
                   "text-anchor='middle'>{}</text>",
                   left + 58, 0.5 * (top + bottom), html_escaped(figure.value_label));
}

}  // namespace

std::string plane_svg(const PlaneFigure& figure) {
  const bool bar = !figure.value_label.empty() && figure.value_max > 0;
  PanelScale scale;
  for (const PlanePath& path : figure.paths) {
    for (std::size_t i = 0; i < std::min(path.x.size(), path.y.size()); ++i) {
      if (!std::isfinite(path.x[i]) || !std::isfinite(path.y[i])) continue;
      scale.x.add(path.x[i]);
      scale.y.add(path.y[i]);
    }
  }
  if (scale.x.empty()) return {};
  scale.left = kPathLeft;
  scale.right = figure.width - kPathRight - (bar ? kBarWidth : 0);
  scale.top = kPathTop;
  scale.bottom = figure.height - kPathBottom;
  scale.x.pad(0.05);
  scale.y.pad(0.05);
  equalise(scale);
  std::string body = axes_svg(figure, scale);
  for (const PlanePath& path : figure.paths) body += path_svg(path, scale, figure.value_max);
  for (const PlanePath& path : figure.paths) body += ends_svg(path, scale);
  if (bar) body += color_bar_svg(figure, scale.right + 12, scale.top, scale.bottom);
  double height = figure.height;
  std::vector<LegendEntry> entries;
  for (const PlanePath& path : figure.paths) {
    if (path.label.empty()) continue;
    const bool heat = !path.value.empty() && figure.value_max > 0;
    entries.push_back(
        {path.label, heat ? fmt::format("heavy h{}", kHeatSteps / 2)
                          : fmt::format("{} c{}", path.band ? "band" : "heavy", path.color % 6)});
  }
  body += svg_legend(entries, kPathLeft, height + 12, figure.width - kPathLeft, height);
  return svg_open(figure.width, height, figure.title) + body + "</svg>";
}

}  // namespace sgs::report
