// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "sgs/report/drawings.h"

namespace sgs::report {
namespace {

constexpr std::size_t kAxes = 6;

std::string axis_name(std::size_t k) { return fmt::format("axis {}", k + 1); }

/// Prior active, condition number with its threshold, planarity: the figure of the paper.
Drawing three_rows(const ReportData& data) {
  PlotFigure figure;
  figure.title = "Prior active, condition number and planarity over time";
  figure.x_label = "time [s]";
  PlotPanel prior, condition, planarity;
  const Column time = time_s(data);
  const Column active = column(data, [](const auto& r) { return r.diagnostics.prior_active; });
  const Column ratio = column(data, [](const auto& r) { return r.diagnostics.condition_number; });
  const Column eta = column(data, [](const auto& r) { return r.diagnostics.planarity; });
  prior.rows = {{"prior", time, active, {"st-off", "st-on"}}};
  condition.series = {{"", 0, time, ratio, false, false}};
  condition.y_label = "condition number";
  condition.log_y = true;
  condition.height = 150;
  if (data.condition_threshold > 0) {
    condition.thresholds = {
        {data.condition_threshold, fmt::format("threshold {:g}", data.condition_threshold)}};
  }
  planarity.series = {{"", 2, time, eta, false, false}};
  planarity.y_label = "planarity";
  planarity.fixed_unit_y = true;
  planarity.height = 110;
  if (data.planarity_threshold > 0) {
    planarity.thresholds = {
        {data.planarity_threshold, fmt::format("threshold {:g}", data.planarity_threshold)}};
  }
  if (has_data(active)) figure.panels.push_back(prior);
  if (has_data(ratio)) figure.panels.push_back(condition);
  if (has_data(eta)) figure.panels.push_back(planarity);
  figure.legend = {{"visual prior active", "st-on"}, {"geometry only", "st-off"}};
  const std::string decided =
      data.decides_by_snr
          ? " This run does not decide by the condition number but by the signal-to-noise ratios "
            "below; the dashed line is the paper's threshold."
          : "";
  return {
      "degeneracy",
      "Where vision helped (prior active), the condition number of the registration (log scale) "
      "and the planarity of the observed normals." +
          decided,
      figure_svg(figure)};
}

Drawing axis_weights(const ReportData& data) {
  PlotFigure figure;
  figure.title = "Weights of the six axes over time";
  figure.x_label = "time [s]";
  PlotPanel panel;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const Column weights = axis_column(data, &tracker::Diagnostics::weights, k);
    if (has_data(weights)) panel.rows.push_back({axis_name(k), time_s(data), weights, {}});
  }
  figure.panels = {panel};
  figure.legend = {{"unseen by geometry, filled by vision", "c0"}};
  return {"weights",
          "Weight of vision along the six principal axes of what geometry sees, the least seen "
          "first: blank 0, seen; blue 1, unseen.",
          figure_svg(figure)};
}

Drawing signal_to_noise(const ReportData& data) {
  PlotFigure figure;
  figure.title = "Signal-to-noise ratio of the six axes over time";
  figure.x_label = "time [s]";
  PlotPanel panel;
  panel.y_label = "signal / noise";
  panel.log_y = true;
  panel.height = 170;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const Column snr = axis_column(data, &tracker::Diagnostics::snr, k);
    if (has_data(snr)) {
      panel.series.push_back({axis_name(k), static_cast<int>(k), time_s(data), snr, false, false});
    }
  }
  if (data.snr_threshold > 0) {
    panel.thresholds = {{data.snr_threshold, "unseen below"},
                        {2 * data.snr_threshold, "seen above"}};
  }
  figure.panels = {panel};
  return {
      "signal_to_noise",
      "Information of the frame's surface about each axis over what noise alone would show (log "
      "scale). Between the dashed lines an axis fades from seen to unseen.",
      figure_svg(figure)};
}

}  // namespace

std::vector<Drawing> degeneracy_drawings(const ReportData& data) {
  std::vector<Drawing> drawings = {three_rows(data), axis_weights(data), signal_to_noise(data)};
  std::erase_if(drawings, [](const Drawing& d) { return d.empty(); });
  return drawings;
}

}  // namespace sgs::report
