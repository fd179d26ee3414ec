// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/report/plot/canvas.h"

namespace sgs::report {
namespace {

constexpr std::size_t kMaxSeriesPoints = 1600;
constexpr std::size_t kStackStretches = 300;

/// Positions to draw: all, or of each of kMaxSeriesPoints / 2 stretches the lowest and the highest.
std::vector<std::size_t> visible_points(const PlotSeries& s) {
  std::vector<std::size_t> kept;
  const std::size_t n = std::min(s.x.size(), s.y.size());
  if (n <= kMaxSeriesPoints) {
    for (std::size_t i = 0; i < n; ++i) kept.push_back(i);
    return kept;
  }
  constexpr std::size_t kStretches = kMaxSeriesPoints / 2;
  for (std::size_t b = 0; b < kStretches; ++b) {
    std::size_t low = b * n / kStretches, high = low;
    const std::size_t end = (b + 1) * n / kStretches;
    std::size_t missing = n;
    for (std::size_t i = low; i < end; ++i) {
      if (!std::isfinite(s.y[i])) missing = i;
      if (!(s.y[low] <= s.y[i])) low = i;
      if (!(s.y[high] >= s.y[i])) high = i;
    }
    kept.push_back(std::min(low, high));
    if (missing < n && missing != low && missing != high) kept.push_back(missing);
    if (low != high) kept.push_back(std::max(low, high));
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

/// Means over stretches of equal length: x, and one row of y per series.
struct Stack {
  std::vector<double> x;
  std::vector<std::vector<double>> y;
};
Stack averaged(const std::vector<PlotSeries>& series) {
  Stack stack;
  if (series.empty()) return stack;
  const std::size_t n = series[0].x.size(), stretches = std::min(n, kStackStretches);
  stack.y.resize(series.size());
  for (std::size_t b = 0; b < stretches; ++b) {
    const std::size_t begin = b * n / stretches, end = (b + 1) * n / stretches;
    const double share = 1.0 / static_cast<double>(end - begin);
    double x = 0;
    for (std::size_t i = begin; i < end; ++i) x += share * series[0].x[i];
    stack.x.push_back(x);
    for (std::size_t s = 0; s < series.size(); ++s) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const double y = series[s].y[i];
        if (std::isfinite(y)) sum += share * y;
      }
      stack.y[s].push_back(sum);
    }
  }
  return stack;
}

}  // namespace

double PanelScale::v(double value) const { return v_linear(log_y ? std::log10(value) : value); }

bool PanelScale::drawable(double xv, double yv) const {
  return std::isfinite(xv) && std::isfinite(yv) && (!log_y || yv > 0);
}

std::string series_svg(const PlotSeries& s, const PanelScale& scale) {
  std::string path;
  bool pen_down = false;
  double start_u = 0;
  const auto lift = [&] {
    if (pen_down && s.filled) path += fmt::format("V{:.1f}H{:.1f}Z", scale.bottom, start_u);
    pen_down = false;
  };
  for (const std::size_t i : visible_points(s)) {
    if (!scale.drawable(s.x[i], s.y[i])) {
      lift();
      continue;
    }
    const double u = scale.u(s.x[i]);
    // A point of its own shows as a dot thanks to the round line caps.
    path += fmt::format("{}{:.1f} {:.1f}{}", pen_down ? "L" : "M", u, scale.v(s.y[i]),
                        pen_down ? "" : "h0");
    if (!pen_down) start_u = u;
    pen_down = true;
  }
  lift();
  return fmt::format("<path class='{} c{}{}' d='{}'/>", s.filled ? "area" : "line", s.color % 6,
                     s.dashed ? " dashed" : "", path);
}

std::string stacked_svg(const std::vector<PlotSeries>& series, const PanelScale& scale) {
  const Stack stack = averaged(series);
  std::vector<double> base(stack.x.size(), 0.0);
  std::string svg;
  for (std::size_t s = 0; s < series.size(); ++s) {
    std::string upper, lower;
    for (std::size_t i = 0; i < stack.x.size(); ++i) {
      const double u = scale.u(stack.x[i]);
      lower = fmt::format("L{:.1f} {:.1f}", u, scale.v(base[i])) + lower;
      base[i] += stack.y[s][i];
      upper += fmt::format("{}{:.1f} {:.1f}", i ? "L" : "M", u, scale.v(base[i]));
    }
    svg += fmt::format("<path class='stack c{}' d='{}{}Z'/>", series[s].color % 6, upper, lower);
  }
  return svg;
}

double stacked_maximum(const std::vector<PlotSeries>& series) {
  const Stack stack = averaged(series);
  double maximum = 0;
  for (std::size_t i = 0; i < stack.x.size(); ++i) {
    double sum = 0;
    for (const auto& y : stack.y) sum += y[i];
    maximum = std::max(maximum, sum);
  }
  return maximum;
}

std::string row_svg(const PlotRow& row, const PanelScale& scale, double top, double bottom) {
  constexpr int kShades = 20;
  const std::size_t n = std::min(row.x.size(), row.value.size());
  const auto step_of = [&](std::size_t i) {
    const double v = row.value[i];
    if (!std::isfinite(v)) return -1;
    if (row.classes.empty())
      return std::clamp(static_cast<int>(std::lround(v * kShades)), 0, kShades);
    if (!(v >= 0 && v < static_cast<double>(row.classes.size()))) return -1;
    return row.classes[static_cast<std::size_t>(v)].empty() ? -1 : static_cast<int>(v);
  };
  std::string svg;
  for (std::size_t i = 0; i < n;) {
    const int step = step_of(i);
    std::size_t end = i + 1;
    while (end < n && step_of(end) == step) ++end;
    if (step > 0 || (step == 0 && !row.classes.empty())) {
      const double u = scale.u(row.x[i]), last = scale.u(row.x[end < n ? end : n - 1]);
      svg += fmt::format(
          "<rect class='bar {}' x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}'{}/>",
          row.classes.empty() ? "c0" : row.classes[static_cast<std::size_t>(step)], u, top,
          std::max(0.8, last - u), bottom - top,
          row.classes.empty()
              ? fmt::format(" fill-opacity='{:g}'", static_cast<double>(step) / kShades)
              : "");
    }
    i = end;
  }
  return svg;
}

}  // namespace sgs::report
