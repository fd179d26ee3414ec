// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "sgs/core/error.h"
#include "sgs/eval/html.h"

namespace sgs::eval {
namespace {

constexpr double kLeft = 58, kRight = 14, kTop = 12, kBottom = 40;
constexpr std::size_t kMaxPoints = 1600;

struct Interval {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  bool empty() const { return !(min <= max); }
  double length() const { return max - min; }
  void add(double v) {
    if (!std::isfinite(v)) return;
    min = std::min(min, v);
    max = std::max(max, v);
  }
  void pad(double share) {
    const double by = length() > 0 ? share * length() : std::max(1e-3, 0.1 * std::abs(min));
    min -= by;
    max += by;
  }
};

/// Round step (1, 2 or 5 times a power of ten) giving about `count` ticks.
double tick_step(double length, int count) {
  const double raw = length / count, power = std::pow(10, std::floor(std::log10(raw)));
  const double m = raw / power;
  return power * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
}

std::string tick_text(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0;
  if (std::abs(value) >= 1e6) return fmt::format("{:.3g}M", value / 1e6);
  if (std::abs(value) >= 1e4) return fmt::format("{:g}k", value / 1e3);
  return fmt::format("{:.{}f}", value,
                     std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6));
}

/// Maps data to the drawing's coordinates.
class Frame {
 public:
  Frame(Interval x, Interval y, const PlotOptions& o)
      : x_(x), y_(y), width_(o.width), height_(o.height), log_(o.log_y) {}
  double u(double x) const {
    return kLeft + (x - x_.min) / x_.length() * (width_ - kLeft - kRight);
  }
  double v_linear(double y) const {
    return height_ - kBottom - (y - y_.min) / y_.length() * (height_ - kTop - kBottom);
  }
  double v(double y) const { return v_linear(log_ ? std::log10(y) : y); }

  std::string axes(const PlotOptions& o) const {
    std::string s;
    const double right = width_ - kRight, bottom = height_ - kBottom;
    const double step_x = tick_step(x_.length(), std::max(2, static_cast<int>(width_ / 100)));
    for (double t = std::ceil(x_.min / step_x) * step_x; t <= x_.max + 1e-9 * step_x; t += step_x) {
      s += fmt::format(
          "<line class='grid' x1='{0:.1f}' y1='{1}' x2='{0:.1f}' y2='{2}'/><text x='{0:.1f}' "
          "y='{3}' text-anchor='middle'>{4}</text>",
          u(t), kTop, bottom, bottom + 15, tick_text(t, step_x));
    }
    const double step_y = log_
                              ? std::max(1.0, std::ceil(y_.length() / 6))
                              : tick_step(y_.length(), std::max(2, static_cast<int>(height_ / 55)));
    for (double t = std::ceil(y_.min / step_y - 1e-9) * step_y; t <= y_.max + 1e-9 * step_y;
         t += step_y) {
      const std::string text = log_ ? (t >= -2 && t <= 4 ? fmt::format("{:g}", std::pow(10, t))
                                                         : fmt::format("1e{:g}", t))
                                    : tick_text(t, step_y);
      s += fmt::format(
          "<line class='grid' x1='{0}' y1='{1:.1f}' x2='{2}' y2='{1:.1f}'/><text x='{3}' "
          "y='{4:.1f}' text-anchor='end'>{5}</text>",
          kLeft, v_linear(t), right, kLeft - 6, v_linear(t) + 4, text);
    }
    s += fmt::format("<text class='label' x='{:.1f}' y='{}' text-anchor='middle'>{}</text>",
                     0.5 * (kLeft + right), height_ - 6, html_escaped(o.x_label));
    s += fmt::format(
        "<text class='label' transform='translate(13 {:.1f}) rotate(-90)' "
        "text-anchor='middle'>{}</text>",
        0.5 * (kTop + bottom), html_escaped(o.y_label));
    return s;
  }

 private:
  Interval x_, y_;
  double width_, height_;
  bool log_;
};

/// Positions to draw: all, or of each of kMaxPoints / 2 stretches the lowest and the highest (for
/// paths, where y is not a function of x, every n-th).
std::vector<std::size_t> visible_points(const PlotSeries& s, bool path) {
  std::vector<std::size_t> kept;
  const std::size_t n = std::min(s.x.size(), s.y.size());
  if (n <= kMaxPoints || path) {
    const std::size_t step = std::max<std::size_t>(1, n / kMaxPoints);
    for (std::size_t i = 0; i < n; i += step) kept.push_back(i);
    if (n > 0 && kept.back() != n - 1) kept.push_back(n - 1);
    return kept;
  }
  constexpr std::size_t kStretches = kMaxPoints / 2;
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

std::string series_path(const PlotSeries& s, const Frame& frame, const PlotOptions& o) {
  std::string path, closed;
  bool pen_down = false;
  double start_u = 0, last_u = 0;
  const double floor_v = o.height - kBottom;
  const auto lift = [&] {
    if (pen_down && s.filled) path += fmt::format("V{:.1f}H{:.1f}Z", floor_v, start_u);
    pen_down = false;
  };
  for (const std::size_t i : visible_points(s, o.equal_axes)) {
    if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i]) || (o.log_y && s.y[i] <= 0)) {
      lift();
      continue;
    }
    last_u = frame.u(s.x[i]);
    if (!pen_down) start_u = last_u;
    // A point of its own shows as a dot thanks to the round line caps.
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", last_u, frame.v(s.y[i]));
    if (!pen_down) path += "h0";
    pen_down = true;
  }
  lift();
  return fmt::format("<path class='{} c{}{}' d='{}'/>", s.filled ? "area" : "line", s.color % 6,
                     s.dashed ? " dashed" : "", path);
}

std::string legend(const std::vector<PlotSeries>& series) {
  std::string s = "<div class='legend'>";
  for (const PlotSeries& one : series) {
    s += fmt::format("<span><i class='c{}{}'></i>{}</span>", one.color % 6,
                     one.dashed ? " dashed" : "", html_escaped(one.label));
  }
  return s + "</div>";
}

/// Widens the shorter axis until both have the same scale.
void equalise(Interval& x, Interval& y, const PlotOptions& o) {
  const double w = o.width - kLeft - kRight, h = o.height - kTop - kBottom;
  const double scale = std::max(x.length() / w, y.length() / h);
  const double grow_x = 0.5 * (scale * w - x.length()), grow_y = 0.5 * (scale * h - y.length());
  x.min -= grow_x;
  x.max += grow_x;
  y.min -= grow_y;
  y.max += grow_y;
}

}  // namespace

std::string plot_svg(const std::vector<PlotSeries>& series, const PlotOptions& o) {
  Interval x, y;
  for (const PlotSeries& s : series) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i]) || (o.log_y && s.y[i] <= 0)) continue;
      x.add(s.x[i]);
      y.add(o.log_y ? std::log10(s.y[i]) : s.y[i]);
    }
  }
  if (x.empty() || y.empty()) return {};
  for (const auto& [value, name] : o.thresholds) y.add(o.log_y ? std::log10(value) : value);
  if (o.from_zero) y.add(0);
  const bool at_zero = o.from_zero && y.min == 0;
  if (o.equal_axes || x.length() <= 0) x.pad(0.05);
  y.pad(0.06);
  if (at_zero) y.min = 0;
  if (o.fixed_unit_y) y = {0, 1.04};
  if (o.equal_axes) equalise(x, y, o);
  const Frame frame(x, y, o);
  std::string svg = fmt::format("<svg viewBox='0 0 {} {}' role='img' aria-label='{}'>", o.width,
                                o.height, html_escaped(o.y_label));
  svg += frame.axes(o);
  for (const PlotSeries& s : series) svg += series_path(s, frame, o);
  for (const auto& [value, name] : o.thresholds) {
    svg += fmt::format(
        "<line class='threshold' x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}'/><text x='{1}' "
        "y='{3:.1f}' text-anchor='end'>{4}</text>",
        kLeft, o.width - kRight, frame.v(value), frame.v(value) - 4, html_escaped(name));
  }
  return svg + "</svg>" + (series.size() > 1 ? legend(series) : "");
}

std::string strip_svg(const std::vector<double>& x, const std::vector<double>& value,
                      const std::vector<std::string>& classes, int width, int height) {
  const std::size_t n = std::min(x.size(), value.size());
  if (n == 0) return {};
  std::string svg =
      fmt::format("<svg viewBox='0 0 {} {}' role='img' aria-label='status'>", width, height);
  const double per_frame = (width - kLeft - kRight) / static_cast<double>(n);
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i + 1;
    while (end < n && value[end] == value[i]) ++end;
    const double v = value[i];
    if (v >= 0 && v < static_cast<double>(classes.size())) {
      svg += fmt::format("<rect class='{}' x='{:.2f}' y='2' width='{:.2f}' height='{}'/>",
                         classes[static_cast<std::size_t>(v)],
                         kLeft + per_frame * static_cast<double>(i),
                         std::max(0.8, per_frame * static_cast<double>(end - i)), height - 4);
    }
    i = end;
  }
  return svg + "</svg>";
}

}  // namespace sgs::eval
