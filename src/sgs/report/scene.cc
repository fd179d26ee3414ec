// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "sgs/core/stopwatch.h"
#include "sgs/report/html.h"

namespace sgs::report {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxPositions = 3000, kMaxKeyframes = 60;
/// Lengths of a Gaussian's axes in the file, a byte each: `kShortestAxis_m` times e^(byte /
/// kAxisSteps).
constexpr double kShortestAxis_m = 0.0005, kAxisSteps = 30;

/// Short in the file: a tenth of a millimetre is plenty for a picture.
Json rounded(double value, double steps_per_unit = 1e4) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * steps_per_unit) / steps_per_unit;
}

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::size_t thinning(std::size_t size, std::size_t limit) {
  return std::max<std::size_t>(1, (size + limit - 1) / limit);
}

Json path_json(const std::vector<Eigen::Vector3d>& points) {
  Json json = Json::array();
  for (std::size_t i = 0; i < points.size(); i += thinning(points.size(), kMaxPositions)) {
    for (int k = 0; k < 3; ++k) json.push_back(rounded(points[i][k]));
  }
  return json;
}

/// The largest weight of vision at the time of each position.
Column unseen_along(const ReportData& run) {
  Column unseen;
  const Column time = time_s(run);
  for (const double t : run.estimate_time_s) {
    const auto at = std::lower_bound(time.begin(), time.end(), t - 1e-6);
    if (at == time.end()) {
      unseen.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto& weights =
        run.frames[static_cast<std::size_t>(at - time.begin())].diagnostics.weights;
    unseen.push_back(*std::max_element(weights.begin(), weights.end()));
  }
  return unseen;
}

Json run_json(const ReportData& run, std::size_t color) {
  const std::size_t step = thinning(run.estimate_m.size(), kMaxPositions);
  const auto column_json = [&](const Column& column, double steps, double factor) {
    Json json = Json::array();
    for (std::size_t i = 0; i < column.size(); i += step) {
      json.push_back(rounded(factor * column[i], steps));
    }
    return column.empty() ? Json() : json;
  };
  return {{"name", run_name(run)},
          {"color", color % 6},
          {"path", path_json(run.estimate_m)},
          {"time", column_json(run.estimate_time_s, 1e3, 1)},
          {"error", column_json(run.estimate_error_m, 1e4, 100)},
          {"unseen", column_json(unseen_along(run), 1e2, 1)}};
}

/// Points as 16-bit steps from the low corner, colours, lengths of the widest axes, and the two
/// widest axes in 127ths of that; little endian, base64.
Json points_json(const std::vector<eval::MapPoint>& points) {
  Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
  if (!points.empty()) low = high = points[0].position_m;
  for (const eval::MapPoint& p : points) {
    low = low.cwiseMin(p.position_m);
    high = high.cwiseMax(p.position_m);
  }
  const float step = std::max(1e-6f, (high - low).maxCoeff() / 65535);
  std::string bytes;
  for (const eval::MapPoint& p : points) {
    for (int k = 0; k < 3; ++k) {
      const auto word = static_cast<unsigned>(std::lround((p.position_m[k] - low[k]) / step));
      bytes += static_cast<char>(word & 0xFF);
      bytes += static_cast<char>(word >> 8 & 0xFF);
    }
  }
  for (const eval::MapPoint& p : points) {
    for (const std::uint8_t c : {p.color.r, p.color.g, p.color.b}) bytes += static_cast<char>(c);
  }
  std::string directions;
  for (const eval::MapPoint& p : points) {
    const double length = std::max(kShortestAxis_m, double{p.axes_m[0].norm()});
    // Rounded up, so that no component exceeds a byte.
    const double steps = std::ceil(kAxisSteps * std::log(length / kShortestAxis_m));
    const long byte = std::clamp(std::lround(steps), 0L, 255L);
    bytes += static_cast<char>(byte);
    const double unit = kShortestAxis_m * std::exp(static_cast<double>(byte) / kAxisSteps) / 127;
    for (const Eigen::Vector3f& axis : p.axes_m) {
      for (int k = 0; k < 3; ++k) {
        directions += static_cast<char>(std::clamp(std::lround(axis[k] / unit), -127L, 127L));
      }
    }
  }
  bytes += directions;
  return {{"count", points.size()},
          {"shortest_axis", kShortestAxis_m},
          {"axis_steps", kAxisSteps},
          {"low", {low.x(), low.y(), low.z()}},
          {"step", step},
          {"data", base64(bytes)}};
}

/// Position, then the camera's axes as columns x y z of the rotation, row by row.
Json keyframes_json(const std::vector<SE3>& keyframes) {
  Json json = Json::array();
  for (std::size_t i = 0; i < keyframes.size(); i += thinning(keyframes.size(), kMaxKeyframes)) {
    Json pose = Json::array();
    for (int k = 0; k < 3; ++k) pose.push_back(rounded(keyframes[i].t[k]));
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        pose.push_back(rounded(keyframes[i].R(row, column), 1e3));
      }
    }
    json.push_back(pose);
  }
  return json;
}

/// Box around the paths and the bulk of the map: single far points must not make it small.
void set_box(Runs runs, Json& json) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const ReportData& run : runs) {
    for (const auto& p : run.truth_m.empty() ? run.estimate_m : run.truth_m) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const eval::MapPoint& p : runs[0].map_points) values.push_back(p.position_m[k]);
    if (values.empty()) continue;
    low[k] = std::min(low[k], quantile(values, 0.05));
    high[k] = std::max(high[k], quantile(values, 0.95));
  }
  json["low"] = vector_json(low);
  json["high"] = vector_json(high);
}

Json scene_json(Runs runs) {
  const Views views = choose_views(runs);
  Json json = {{"up", vector_json(views.up)},
               {"across", vector_json(views.across)},
               {"points", points_json(runs[0].map_points)},
               {"keyframes", runs.size() == 1 ? keyframes_json(runs[0].keyframes) : Json::array()},
               {"truth", Json::array()},
               {"error_max", nullptr}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].estimate_m.empty()) json["runs"].push_back(run_json(runs[i], i));
    if (json["truth"].empty()) json["truth"] = path_json(runs[i].truth_m);
  }
  Column errors = runs[0].estimate_error_m;
  std::erase_if(errors, [](double v) { return !std::isfinite(v); });
  if (!errors.empty()) json["error_max"] = rounded(100 * quantile(errors, 0.98));
  set_box(runs, json);
  return json;
}

std::string checkbox(const char* name, const char* label) {
  return fmt::format("<label><input type='checkbox' name='{}' checked> {}</label>", name, label);
}

std::string tools_html(Runs runs, const Json& json) {
  std::string html = "<div class='tools'>";
  if (json["points"]["count"] > 0) html += checkbox("map", "map");
  if (!json["truth"].empty()) html += checkbox("truth", "ground truth");
  if (!json["keyframes"].empty()) html += checkbox("cameras", "keyframes");
  const bool error = runs.size() == 1 && json["error_max"].is_number();
  const bool unseen = runs.size() == 1 && json["runs"][0]["unseen"].is_array();
  if (error || unseen) {
    html += "<label>colour <select>";
    if (error) html += "<option value='error'>error</option>";
    if (unseen) html += "<option value='unseen'>weight of vision</option>";
    html += "</select></label>";
  }
  html +=
      "<span><button name='above'>above</button> <button name='side'>side</button> <button "
      "name='reset'>reset</button></span>";
  const Json& time = json["runs"][0]["time"];
  if (time.is_array() && !time.empty()) {
    html += fmt::format(
        "<input type='range' min='{0}' max='{1}' step='0.01' value='{0}' aria-label='time'>"
        "<output></output>",
        time.front().get<double>(), time.back().get<double>());
  }
  return html + "</div>";
}

}  // namespace

std::string scene_html(Runs runs) {
  if (runs.empty()) return {};
  const Json json = scene_json(runs);
  if (!json.contains("runs")) return {};
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  // The text of a script element must not contain its own end.
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) {
    text.replace(at, 1, "\\u003c");
  }
  return "<figure class='scene'><canvas tabindex='0' role='img' aria-label='Trajectory in three "
         "dimensions; arrow keys turn it, plus and minus zoom'></canvas>" +
         tools_html(runs, json) + "<script type='application/json'>" + text +
         "</script><figcaption>Trajectory and map in three dimensions. Drag to turn, shift-drag to "
         "move; after a click the wheel zooms. The time slider and the plots below share one "
         "cursor.</figcaption></figure>\n";
}

}  // namespace sgs::report
