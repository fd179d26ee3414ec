// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/core/stopwatch.h"
#include "sgs/report/drawings.h"
#include "sgs/report/html.h"
#include "sgs/report/plot/path.h"
#include "sgs/report/plot/scale.h"

namespace sgs::report {
namespace {

constexpr double kCm = 100;

std::string axis_name(const Eigen::Vector3d& direction) {
  constexpr std::string_view kNames[] = {"x [m]", "y [m]", "z [m]"};
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return (direction[axis] < 0 ? "−" : "") + std::string(kNames[axis]);
}

const ReportData* with_truth(Runs runs) {
  const auto found = std::find_if(runs.begin(), runs.end(),
                                  [](const ReportData& run) { return !run.truth_m.empty(); });
  return found == runs.end() ? nullptr : &*found;
}

Column along(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction) {
  Column c;
  for (const auto& p : points) c.push_back(direction.dot(p));
  return c;
}

/// Upper end of the colour scale in centimetres: nearly all errors lie below.
double color_scale_cm(const ReportData& run) {
  Column errors = run.estimate_error_m;
  std::erase_if(errors, [](double v) { return !std::isfinite(v); });
  return errors.empty() ? 0 : kCm * quantile(errors, 0.98);
}

std::string plane_view(Runs runs, const std::string& title, const Eigen::Vector3d& right,
                       const Eigen::Vector3d& up, const std::string& right_name,
                       const std::string& up_name) {
  PlaneFigure figure;
  figure.title = title;
  figure.x_label = right_name;
  figure.y_label = up_name;
  if (const ReportData* truth = with_truth(runs)) {
    figure.paths.push_back({"ground truth",
                            5,
                            along(truth->truth_m, right),
                            along(truth->truth_m, up),
                            {},
                            true,
                            runs.size() > 1});
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ReportData& run = runs[i];
    if (run.estimate_m.empty()) continue;
    PlanePath path{runs.size() > 1 ? run_name(run) : "estimate",
                   static_cast<int>(i),
                   along(run.estimate_m, right),
                   along(run.estimate_m, up),
                   {},
                   false,
                   runs.size() == 1 || with_truth(runs) == nullptr};
    if (runs.size() == 1) {
      path.value = run.estimate_error_m;
      for (double& v : path.value) v *= kCm;
      figure.value_max = color_scale_cm(run);
      if (figure.value_max > 0) figure.value_label = "error [cm]";
    }
    figure.paths.push_back(std::move(path));
  }
  return plane_svg(figure);
}

/// How far the paths reach along a direction, metres.
double extent_along(Runs runs, const Eigen::Vector3d& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ReportData& run : runs) {
    for (const auto& p : run.truth_m.empty() ? run.estimate_m : run.truth_m) {
      low = std::min(low, p.dot(direction));
      high = std::max(high, p.dot(direction));
    }
  }
  return high - low;
}

/// Views where no axis of the world is upright; the two others that lie most level are laid level.
Views tilted_views(Runs runs, const Eigen::Vector3d& up, int vertical) {
  Views views;
  views.up = up;
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit((vertical + 1) % 3);
  const Eigen::Vector3d one = (axis - axis.dot(up) * up).normalized(), other = up.cross(one);
  views.across = extent_along(runs, other) > extent_along(runs, one) ? other : one;
  views.away = up.cross(views.across);
  views.across_name = "across [m]";
  views.away_name = "away [m]";
  views.up_name = "up [m]";
  return views;
}

}  // namespace

Views choose_views(Runs runs) {
  constexpr double kNearAxis = 0.98;  // cosine: within some eleven degrees
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low, up = Eigen::Vector3d::Zero();
  for (const ReportData& run : runs) {
    if (up.isZero()) up = run.up;
    for (const auto& p : run.truth_m.empty() ? run.estimate_m : run.truth_m) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const Eigen::Vector3d extent = high - low;
  int vertical = 2;
  if (up.isZero()) {
    extent.minCoeff(&vertical);
  } else {
    up.cwiseAbs().maxCoeff(&vertical);
  }
  if (!up.isZero() && up.cwiseAbs().maxCoeff() < kNearAxis) {
    return tilted_views(runs, up.normalized(), vertical);
  }
  Views views;
  views.up = Eigen::Vector3d::Unit(vertical) * (up[vertical] < 0 ? -1 : 1);
  const int a = (vertical + 1) % 3, b = (vertical + 2) % 3;
  views.across = Eigen::Vector3d::Unit(extent[b] > extent[a] ? b : a);
  // Seen from above: across to the right, away up the page, `up` towards the reader.
  views.away = views.up.cross(views.across);
  views.across_name = axis_name(views.across);
  views.away_name = axis_name(views.away);
  views.up_name = axis_name(views.up);
  return views;
}

std::vector<Drawing> trajectory_drawings(Runs runs) {
  const bool any = std::any_of(runs.begin(), runs.end(),
                               [](const ReportData& run) { return !run.estimate_m.empty(); });
  if (!any) return {};
  const Views v = choose_views(runs);
  const std::string reference =
      with_truth(runs) == nullptr ? "There is no ground truth; the path starts at the origin."
      : runs.size() == 1
          ? "The colour is the translation error after a rigid alignment; ring: start, disc: end."
          : "Each run aligned to the ground truth by a rigid motion.";
  std::vector<Drawing> drawings;
  drawings.push_back(
      {"trajectory_top", "Trajectory from above. " + reference,
       plane_view(runs, "Trajectory from above", v.across, v.away, v.across_name, v.away_name)});
  drawings.push_back(
      {"trajectory_side", "Trajectory from the side, up is up.",
       plane_view(runs, "Trajectory from the side", v.across, v.up, v.across_name, v.up_name)});
  std::erase_if(drawings, [](const Drawing& d) { return d.empty(); });
  return drawings;
}

std::vector<Drawing> error_drawings(Runs runs) {
  PlotFigure figure;
  figure.title = "Translation error over time";
  figure.x_label = "time [s]";
  PlotPanel rows, errors;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ReportData& run = runs[i];
    const Column status = status_column(run), time = time_s(run);
    if (has_data(status)) {
      rows.rows.push_back({runs.size() > 1 ? fmt::format("run {}", i + 1) : "status",
                           time,
                           status,
                           {"st-ok", "st-degenerate", "st-lost", "st-bad"}});
    }
    if (!has_data(run.error_m)) continue;
    PlotSeries series{run_name(run), static_cast<int>(i), time, run.error_m, false, false};
    for (double& v : series.y) v *= kCm;
    const double rmse = kCm * run.metrics.ate_rmse_m.value_or(0);
    low = std::min(low, rmse);
    high = std::max(high, rmse);
    errors.series.push_back(std::move(series));
    if (runs.size() == 1 && rmse > 0) {
      errors.thresholds = {{rmse, fmt::format("RMSE {} cm", short_number(rmse))}};
    }
  }
  errors.y_label = "error [cm]";
  errors.from_zero = true;
  // Runs that differ by an order of magnitude would hide each other on a linear axis.
  errors.log_y = errors.series.size() > 1 && low > 0 && high > 8 * low;
  errors.height = 190;
  figure.panels = {rows, errors};
  for (std::size_t i = 0; i < runs.size() && runs.size() > 1; ++i) {
    figure.legend.emplace_back(run_name(runs[i]), fmt::format("c{}", i % 6));
  }
  const std::pair<const char*, const char*> states[] = {
      {"tracked", "st-ok"},
      {"degenerate: geometry does not see every axis", "st-degenerate"},
      {"lost", "st-lost"},
      {"bad frame", "st-bad"}};
  for (std::size_t k = 0; k < std::size(states); ++k) {
    const bool occurs = std::any_of(runs.begin(), runs.end(), [&](const ReportData& run) {
      const Column status = status_column(run);
      return std::find(status.begin(), status.end(), static_cast<double>(k)) != status.end();
    });
    if (occurs) figure.legend.emplace_back(states[k].first, states[k].second);
  }
  Drawing drawing{"error",
                  "Tracking status and translation error per frame, after the alignment" +
                      std::string(errors.log_y ? " (log scale)." : "."),
                  figure_svg(figure)};
  return drawing.empty() ? std::vector<Drawing>{} : std::vector<Drawing>{drawing};
}

}  // namespace sgs::report
