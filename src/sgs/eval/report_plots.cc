// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/report_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/eval/html.h"
#include "sgs/eval/svg_plot.h"

namespace sgs::eval {
namespace {

bool has_data(const Column& column) {
  return std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
}

Column scaled(const Column& column, double factor) {
  Column result = column;
  for (double& v : result) v *= factor;
  return result;
}

std::string figure(const std::string& caption, const std::string& content) {
  if (content.empty()) return {};
  return fmt::format("<figure><figcaption>{}</figcaption>{}</figure>", caption, content);
}

/// A plot of one column over time; "" without data.
std::string over_time(const ReportData& data, const Column& column, const std::string& caption,
                      PlotOptions options, int color) {
  if (!has_data(column)) return {};
  options.x_label = "time [s]";
  return figure(caption, plot_svg({{"", color, data.time_s, column, false, false}}, options));
}

/// Axes of the top and side view: the vertical one and the two others, the longer one first.
struct Views {
  int horizontal = 0, second = 1, vertical = 2;
};
Views choose_views(const ReportData& data) {
  const auto& points = data.truth_m.empty() ? data.estimate_m : data.truth_m;
  Eigen::Vector3d low = points[0], high = points[0];
  for (const auto& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d extent = high - low;
  Views v;
  if (data.up.norm() > 0) {
    data.up.cwiseAbs().maxCoeff(&v.vertical);
  } else {
    extent.minCoeff(&v.vertical);
  }
  v.horizontal = (v.vertical + 1) % 3;
  v.second = (v.vertical + 2) % 3;
  if (extent[v.second] > extent[v.horizontal]) std::swap(v.horizontal, v.second);
  return v;
}

Column coordinate(const std::vector<Eigen::Vector3d>& points, int axis, double sign = 1) {
  Column c;
  for (const auto& p : points) c.push_back(sign * p[axis]);
  return c;
}

std::string path_plot(const ReportData& data, int across, int upward, double sign) {
  const std::string names[] = {"x [m]", "y [m]", "z [m]"};
  PlotOptions o;
  o.x_label = names[across];
  o.y_label = (sign < 0 ? "−" : "") + names[upward];
  o.equal_axes = true;
  o.width = 480;
  o.height = 380;
  std::vector<PlotSeries> series;
  if (!data.truth_m.empty()) {
    series.push_back({"ground truth", 5, coordinate(data.truth_m, across),
                      coordinate(data.truth_m, upward, sign), true, false});
  }
  series.push_back({"estimate", 0, coordinate(data.estimate_m, across),
                    coordinate(data.estimate_m, upward, sign), false, false});
  return plot_svg(series, o);
}

}  // namespace

std::string section_html(const std::string& title, const std::string& lead,
                         const std::string& content) {
  if (content.empty()) return {};
  return "<section><h2>" + title + "</h2>" +
         (lead.empty() ? "" : "<p class='lead'>" + lead + "</p>") + content + "</section>\n";
}

std::string trajectory_section(const ReportData& data) {
  if (data.estimate_m.empty()) return {};
  const Views v = choose_views(data);
  const double sign = data.up[v.vertical] < 0 ? -1 : 1;
  std::string html = "<div class='pair'>";
  html += figure("Seen from above", path_plot(data, v.horizontal, v.second, 1));
  html += figure("Seen from the side", path_plot(data, v.horizontal, v.vertical, sign));
  html += "</div>";
  return section_html("Trajectory",
                      data.truth_m.empty()
                          ? "No ground truth: the path starts at the identity."
                          : "Estimate aligned to ground truth by a rigid motion; equal axes.",
                      html);
}

std::string tracking_section(const ReportData& data) {
  PlotOptions error;
  error.y_label = "error [cm]";
  error.from_zero = true;
  std::string html = over_time(data, scaled(data.error_m, 100),
                               "Translation error per frame, after alignment", error, 0);
  if (has_data(data.status)) {
    html += figure(
        "Tracking status over time",
        strip_svg(data.time_s, data.status, {"st-ok", "st-degenerate", "st-lost", "st-bad"}) +
            "<div class='legend'><span><i class='st-ok'></i>tracked</span><span><i "
            "class='st-degenerate'></i>degenerate</span><span><i class='st-lost'></i>lost</span>"
            "<span><i class='st-bad'></i>bad frame</span></div>");
  }
  return section_html("Tracking", "", html);
}

std::string degeneracy_section(const ReportData& data) {
  std::string html;
  if (has_data(data.prior_active)) {
    html +=
        figure("Prior active", strip_svg(data.time_s, data.prior_active, {"st-off", "st-on"}) +
                                   "<div class='legend'><span><i class='st-on'></i>visual prior "
                                   "used</span><span><i class='st-off'></i>geometry only</span>"
                                   "</div>");
  }
  PlotOptions condition;
  condition.y_label = "condition number";
  condition.log_y = true;
  condition.height = 190;
  if (data.condition_threshold > 0)
    condition.thresholds = {{data.condition_threshold, "threshold"}};
  html += over_time(data, data.condition_number, "Condition number of the registration (log scale)",
                    condition, 0);
  PlotOptions planarity;
  planarity.y_label = "planarity";
  planarity.fixed_unit_y = true;
  planarity.height = 170;
  if (data.planarity_threshold > 0)
    planarity.thresholds = {{data.planarity_threshold, "threshold"}};
  html += over_time(data, data.planarity, "Planarity of the observed normals", planarity, 2);
  std::string rows;
  for (std::size_t k = 0; k < data.weights.size(); ++k) {
    if (!has_data(data.weights[k])) continue;
    PlotOptions o;
    o.x_label = k == 5 ? "time [s]" : "";
    o.y_label = "weight";
    o.fixed_unit_y = true;
    o.width = 480;
    o.height = 130;
    rows +=
        figure(fmt::format("Axis {}{}", k + 1, k == 0 ? ", seen least" : ""),
               plot_svg({{"", static_cast<int>(k), data.time_s, data.weights[k], false, true}}, o));
  }
  if (!rows.empty()) {
    html +=
        "<p class='lead'>Weight of vision along the six principal axes of what geometry sees, the "
        "least seen first: 0 seen by geometry, 1 unseen and filled by vision.</p><div "
        "class='pair'>" +
        rows + "</div>";
  }
  return section_html("Degeneracy", "", html);
}

std::string timing_section(const ReportData& data) {
  PlotOptions o;
  o.from_zero = true;
  o.width = 480;
  o.height = 220;
  o.y_label = "tracking [ms]";
  std::string html = over_time(data, data.track_ms, "Tracking time per frame", o, 0);
  o.y_label = "frames / s";
  html += over_time(data, data.fps, "System rate", o, 2);
  o.y_label = "iterations";
  html += over_time(data, data.iterations, "Mapping iterations", o, 1);
  o.y_label = "Gaussians";
  html += over_time(data, data.gaussians, "Gaussians in the map", o, 3);
  if (html.empty()) return {};
  return section_html("Timing and map", "", "<div class='pair'>" + html + "</div>");
}

}  // namespace sgs::eval
