// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <map>
#include <type_traits>

#include "sgs/report/drawings.h"

namespace sgs::report {
namespace {

/// A column of frames.csv with its values; NaN for bad frames.
struct ValueColumn {
  slam::FrameColumn info;
  Column values;
};

/// The columns that hold one number per frame, in the order of frames.csv.
std::vector<ValueColumn> value_columns(const ReportData& data) {
  std::vector<ValueColumn> columns;
  std::map<std::string_view, std::size_t> place;
  for (const slam::FrameRecord& frame : data.frames) {
    slam::visit_columns(frame, [&](const slam::FrameColumn& c, const auto& value) {
      if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
        const auto [at, is_new] = place.try_emplace(c.key, columns.size());
        if (is_new) columns.push_back({c, {}});
        columns[at->second].values.push_back(frame.bad ? std::numeric_limits<double>::quiet_NaN()
                                                       : static_cast<double>(value));
      }
    });
  }
  return columns;
}

/// Whether there is something to see: two different values.
bool varies(const Column& values) {
  const double* first = nullptr;
  for (const double& value : values) {
    if (std::isnan(value)) continue;
    if (first != nullptr && value != *first) return true;
    first = &value;
  }
  return false;
}

}  // namespace

std::vector<Drawing> value_drawings(const ReportData& data) {
  const Column time = time_s(data);
  std::vector<Drawing> drawings;
  for (const ValueColumn& column : value_columns(data)) {
    if (column.info.key == "index" || column.info.key == "timestamp_s") continue;
    if (!varies(column.values)) continue;
    PlotFigure figure;
    figure.title = std::string(column.info.key) + " over time";
    figure.x_label = "time [s]";
    PlotPanel panel;
    panel.series = {{"", 0, time, column.values, false, false}};
    panel.y_label = std::string(column.info.unit);
    panel.height = 90;
    figure.panels = {panel};
    drawings.push_back({"value_" + std::string(column.info.key),
                        std::string(column.info.key) + ": " + std::string(column.info.meaning),
                        figure_svg(figure)});
  }
  return drawings;
}

}  // namespace sgs::report
