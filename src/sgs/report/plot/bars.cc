// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/report/html.h"
#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/scale.h"

namespace sgs::report {
namespace {

constexpr double kLeft = 66, kRight = 14, kTop = 10, kBottom = 38;

std::string power_text(double exponent) {
  return exponent >= -3 && exponent <= 3 ? fmt::format("{:g}", std::pow(10, exponent))
                                         : fmt::format("1e{:g}", exponent);
}

}  // namespace

std::string histogram_svg(const std::string& title, const std::string& x_label,
                          const std::vector<HistogramSeries>& series, bool log_x, int width,
                          int height) {
  Interval x, y{0, 0};
  for (const HistogramSeries& s : series) {
    const double total = s.histogram.total();
    if (total <= 0) continue;
    x.add(s.histogram.min);
    x.add(s.histogram.max);
    for (const double c : s.histogram.counts) y.add(100 * c / total);
  }
  if (x.empty()) return {};
  y.max *= 1.06;
  const double right = width - kRight, bottom = height - kBottom;
  const auto u = [&](double v) { return kLeft + (v - x.min) / x.length() * (right - kLeft); };
  const auto v = [&](double share) { return bottom - share / y.max * (bottom - kTop); };
  std::string body;
  for (const Tick& t : log_x ? log_ticks(x) : linear_ticks(x, 6)) {
    body += fmt::format("<path class='grid' d='M{:.1f} {}V{:.1f}'/>", u(t.at), kTop, bottom);
    body += svg_text(u(t.at), bottom + 15, log_x ? power_text(t.at) : t.text, TextAnchor::kMiddle);
  }
  for (const Tick& t : linear_ticks(y, 4)) {
    body += fmt::format("<path class='grid' d='M{} {:.1f}H{:.1f}'/>", kLeft, v(t.at), right);
    body += svg_text(kLeft - 6, v(t.at) + 4, t.text, TextAnchor::kEnd);
  }
  std::vector<LegendEntry> legend;
  for (const HistogramSeries& s : series) {
    const eval::Histogram& h = s.histogram;
    const double total = h.total(), bin = (h.max - h.min) / static_cast<double>(h.counts.size());
    if (total <= 0) continue;
    std::string path = fmt::format("M{:.1f} {:.1f}", u(h.min), bottom);
    for (std::size_t i = 0; i < h.counts.size(); ++i) {
      path += fmt::format("V{:.1f}H{:.1f}", v(100 * h.counts[i] / total),
                          u(h.min + bin * static_cast<double>(i + 1)));
    }
    body += fmt::format("<path class='area c{}' d='{}V{:.1f}Z'/>", s.color % 6, path, bottom);
    if (series.size() > 1) legend.push_back({s.label, fmt::format("c{}", s.color % 6), true});
  }
  body += svg_text(0.5 * (kLeft + right), bottom + 31, x_label, TextAnchor::kMiddle, "label");
  body += fmt::format(
      "<text class='label' transform='translate(13 {:.1f}) rotate(-90)' "
      "text-anchor='middle'>share [%]</text>",
      0.5 * (kTop + bottom));
  double total_height = height;
  body += svg_legend(legend, kLeft, total_height + 12, right - kLeft, total_height);
  return svg_open(width, total_height, title) + body + "</svg>";
}

std::string bars_svg(const std::string& title, const std::string& x_label,
                     const std::vector<Bar>& bars, int width) {
  if (bars.empty()) return {};
  constexpr double kNames = 190, kTexts = 250, kRow = 22, kBar = 13;
  Interval x{0, 0};
  for (const Bar& bar : bars) {
    x.add(bar.value);
    x.add(bar.whisker);
  }
  if (x.max <= 0) x.max = 1;
  const double right = width - kTexts, bottom = kTop + kRow * static_cast<double>(bars.size());
  const auto u = [&](double v) { return kNames + v / x.max * (right - kNames); };
  std::string body;
  for (const Tick& t : linear_ticks(x, 6)) {
    body += fmt::format("<path class='grid' d='M{:.1f} {}V{:.1f}'/>", u(t.at), kTop, bottom);
    body += svg_text(u(t.at), bottom + 15, t.text, TextAnchor::kMiddle);
  }
  double middle = kTop + 0.5 * kRow;
  for (const Bar& bar : bars) {
    body += svg_text(bar.indented ? 22 : 8, middle + 4, bar.label, TextAnchor::kStart,
                     bar.indented ? "" : "label");
    body +=
        fmt::format("<rect class='bar c{}' x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{}'{}/>",
                    bar.color % 6, u(0), middle - 0.5 * kBar, u(bar.value) - u(0), kBar,
                    bar.indented ? " fill-opacity='.65'" : "");
    if (bar.whisker > bar.value) {
      body += fmt::format("<path class='line c5' d='M{0:.1f} {1:.1f}H{2:.1f}M{2:.1f} {3:.1f}v8'/>",
                          u(bar.value), middle, u(bar.whisker), middle - 4);
    }
    body += svg_text(right + 14, middle + 4, bar.text, TextAnchor::kStart);
    middle += kRow;
  }
  body += svg_text(0.5 * (kNames + right), bottom + 31, x_label, TextAnchor::kMiddle, "label");
  return svg_open(width, bottom + kBottom, title) + body + "</svg>";
}

}  // namespace sgs::report
