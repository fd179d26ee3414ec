// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <type_traits>

#include "sgs/report/drawings.h"
#include "sgs/report/plot/bars.h"

namespace sgs::report {
namespace {

bool below(const StageSummary& part, const std::string& whole) {
  return part.name.starts_with(whole + "/");
}

/// Bars per stage, each level ordered by time; groups without a stage of their own are summed.
std::vector<Bar> stage_bars(const std::vector<StageSummary>& stages, double frames) {
  std::vector<StageSummary> groups;
  for (const StageSummary& stage : stages) {
    const std::string group = stage.name.substr(0, stage.name.find('/'));
    const auto known = std::find_if(groups.begin(), groups.end(),
                                    [&](const StageSummary& g) { return g.name == group; });
    if (known == groups.end()) {
      groups.push_back({group, 0, 0, 0, 0});
    }
  }
  std::vector<Bar> bars;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<StageSummary> parts;
    StageSummary whole = groups[g];
    for (const StageSummary& stage : stages) {
      if (stage.name == whole.name) whole = stage;
      if (below(stage, groups[g].name)) parts.push_back(stage);
    }
    if (whole.calls == 0) {
      for (const StageSummary& part : parts) whole.total_ms += part.total_ms;
    }
    std::sort(parts.begin(), parts.end(),
              [](const StageSummary& a, const StageSummary& b) { return a.total_ms > b.total_ms; });
    const auto add = [&](const StageSummary& s, bool indented) {
      std::string text = fmt::format("{:.2f} ms", s.total_ms / frames);
      if (s.calls > 0) {
        text += fmt::format("  (p50 {:.2f}, p95 {:.2f}, {}×)", s.p50_ms, s.p95_ms, s.calls);
      }
      bars.push_back({indented ? s.name.substr(groups[g].name.size() + 1) : s.name,
                      s.total_ms / frames, 0, text, static_cast<int>(g), indented});
    };
    add(whole, false);
    for (const StageSummary& part : parts) add(part, true);
  }
  return bars;
}

Drawing stage_drawing(const ReportData& data) {
  const double frames = std::max<double>(1, static_cast<double>(data.frames.size()));
  return {
      "timing",
      "Milliseconds per frame of the sequence, by stage (in brackets: median and 95th "
      "percentile of one call in ms, number of calls). Tracking is CPU time of one thread; "
      "mapping runs beside it.",
      bars_svg("Milliseconds per frame by stage", "ms per frame", stage_bars(data.stages, frames))};
}

Drawing tracking_parts(const ReportData& data) {
  PlotFigure figure;
  figure.title = "Tracking time per frame by part";
  figure.x_label = "time [s]";
  PlotPanel panel;
  panel.y_label = "tracking [ms]";
  panel.height = 150;
  // Every column of time per part, whatever parts there are.
  const Column time = time_s(data);
  std::map<std::string, Column> parts;
  std::vector<std::string> names;
  for (const slam::FrameRecord& frame : data.frames) {
    slam::visit_columns(frame, [&](const slam::FrameColumn& c, const auto& value) {
      if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) {
        if (!c.key.starts_with("ms_")) return;
        const std::string name(c.key.substr(3));
        if (!parts.contains(name)) names.push_back(name);
        parts[name].push_back(frame.bad ? std::numeric_limits<double>::quiet_NaN() : value);
      }
    });
  }
  for (const std::string& name : names) {
    if (has_data(parts[name])) {
      panel.series.push_back(
          {name, static_cast<int>(panel.series.size()), time, parts[name], false, false});
    }
  }
  panel.stacked = !panel.series.empty();
  if (panel.series.empty()) {
    const Column track_ms = column(data, [](const auto& r) { return r.track_ms; });
    panel.series = {{"", 0, time, track_ms, false, false}};
    panel.from_zero = true;
  }
  figure.panels = {panel};
  return {"tracking_time", "CPU time of tracking over the sequence, by part.", figure_svg(figure)};
}

Drawing growth(const ReportData& data) {
  PlotFigure figure;
  figure.title = "Gaussians and mapping iterations over time";
  figure.x_label = "time [s]";
  PlotPanel keyframes, gaussians, iterations;
  const Column time = time_s(data);
  const Column is_keyframe = column(data, [](const auto& r) { return r.mapping_keyframe; });
  const Column count = column(data, [](const auto& r) { return r.gaussians; });
  const Column steps = column(data, [](const auto& r) { return r.iterations; });
  keyframes.rows = {{"keyframes", time, is_keyframe, {"", "st-on"}}};
  gaussians.series = {{"", 0, time, count, false, false}};
  gaussians.y_label = "Gaussians";
  iterations.series = {{"", 1, time, steps, false, false}};
  iterations.y_label = "iterations";
  gaussians.from_zero = iterations.from_zero = true;
  gaussians.height = 130;
  iterations.height = 90;
  if (has_data(is_keyframe)) figure.panels.push_back(keyframes);
  if (has_data(count)) figure.panels.push_back(gaussians);
  if (has_data(steps)) figure.panels.push_back(iterations);
  return {
      "map_growth",
      "Mapping keyframes, Gaussians in the map that each frame was tracked against, and mapping "
      "iterations so far.",
      figure_svg(figure)};
}

}  // namespace

std::vector<Drawing> timing_drawings(const ReportData& data) {
  std::vector<Drawing> drawings = {stage_drawing(data), tracking_parts(data)};
  std::erase_if(drawings, [](const Drawing& d) { return d.empty(); });
  return drawings;
}

std::vector<Drawing> map_drawings(const ReportData& data) {
  std::vector<Drawing> drawings = {
      growth(data),
      {"map_opacity", "Opacity of the Gaussians.",
       histogram_svg("Opacity of the Gaussians", "opacity", {{"", 0, data.map.opacity}}, false)},
      {"map_scale", "Standard deviations of the Gaussians along their three axes (log scale).",
       histogram_svg("Standard deviations of the Gaussians", "standard deviation [m]",
                     {{"thinnest", 0, data.map.thinnest},
                      {"middle", 2, data.map.middle},
                      {"widest", 1, data.map.widest}},
                     true)}};
  std::erase_if(drawings, [](const Drawing& d) { return d.empty(); });
  return drawings;
}

}  // namespace sgs::report
