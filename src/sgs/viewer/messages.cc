// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

namespace sgs::viewer {
namespace {

using Json = nlohmann::json;

/// Seven significant digits, null where there is no number.
Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.7g}", value).c_str(), nullptr);
}

template <class Array>
Json numbers(const Array& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number(value));
  return out;
}

/// Null instead of a list when nothing of it was measured.
Json measured(const std::array<double, 6>& values) {
  const bool none =
      std::all_of(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  return none ? Json() : numbers(values);
}

Json axes_json(const std::optional<Matrix6d>& axes) {
  if (!axes) return nullptr;
  Json out = Json::array();
  for (int k = 0; k < 6; ++k) {
    const Vector6d axis = axes->col(k);
    out.push_back(numbers(axis));
  }
  return out;
}

std::string pose_text(const PathPoint::Pose& pose) {
  const bool finite =
      std::all_of(pose.begin(), pose.end(), [](float v) { return std::isfinite(v); });
  return finite ? fmt::format("[{:.7g}]", fmt::join(pose, ",")) : "null";
}

/// JSON text also of what is not UTF-8 (names of folders need not be).
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string hello_message(const RunInfo& info) {
  constexpr int kProtocol = 1;
  constexpr int kPictureAbove = 150000;  // what phones and software WebGL draw is far less
  const PinholeCamera& c = info.camera;
  Json json = {{"type", "hello"},         {"protocol", kProtocol},
               {"version", info.version}, {"input", info.input},
               {"tracker", info.tracker}, {"preset", info.preset},
               {"live", info.live},       {"up", nullptr},
               {"frames_total", nullptr}, {"picture_above", kPictureAbove}};
  if (info.frames_total) json["frames_total"] = *info.frames_total;
  json["camera"] = {{"fx", number(c.fx)}, {"fy", number(c.fy)}, {"cx", number(c.cx)},
                    {"cy", number(c.cy)}, {"width", c.width},   {"height", c.height}};
  return dump(json);
}

std::string path_message(std::size_t first, std::span<const PathPoint> points) {
  std::string estimate, truth, status;
  for (const PathPoint& point : points) {
    const char* separator = estimate.empty() ? "" : ",";
    estimate += separator + pose_text(point.estimate);
    truth += separator + (point.has_truth ? pose_text(point.truth) : "null");
    status += separator + std::to_string(static_cast<int>(point.status));
  }
  return fmt::format(R"({{"type":"path","first":{},"estimate":[{}],"truth":[{}],"status":[{}]}})",
                     first, estimate, truth, status);
}

std::string state_message(const FrameUpdate& update, bool paused) {
  const slam::FrameRecord& r = update.record;
  const tracker::Diagnostics& d = r.diagnostics;
  const std::size_t gaussians =
      update.map ? update.map->gaussians.size() : static_cast<std::size_t>(r.gaussians);
  Json json = {{"type", "state"},
               {"frame", r.index},
               {"time", r.timestamp_s},
               {"status", tracker::to_string(r.status)},
               {"pose", Json::parse(pose_text(to_pose(update.T_world_camera)))},
               {"truth", update.truth ? Json::parse(pose_text(to_pose(*update.truth))) : Json()},
               {"keyframe", r.mapping_keyframe},
               {"map_version", update.map ? update.map->version : 0},
               {"gaussians", gaussians},
               {"snr", measured(d.snr)},
               {"weights", numbers(d.weights)},
               {"axes", axes_json(update.axes)},
               {"mask", d.degenerate_mask},
               {"eigenvalues", measured(d.eigenvalues)},
               {"condition", number(d.condition_number)},
               {"planarity", number(d.planarity)},
               {"prior_active", d.prior_active},
               {"prior_source", tracker::to_string(d.prior_source)},
               {"inliers", d.inliers},
               {"visual_inliers", d.visual_inliers},
               {"overlap", number(d.overlap)},
               {"ms", {{"track", number(r.track_ms)}, {"map", number(update.map_ms)}}},
               {"fps", number(update.fps)},
               {"iterations", r.iterations},
               {"paused", paused},
               {"finished", update.finished}};
  return dump(json);
}

std::string metrics_message(std::string_view metrics_json) {
  Json json = Json::parse(metrics_json, nullptr, false);
  if (!json.is_object()) return error_message("the run's metrics could not be read");
  json["type"] = "metrics";
  return dump(json);
}

std::string error_message(std::string_view text) {
  return dump({{"type", "error"}, {"message", text}});
}

std::string picture_message(Pane pane, std::uint32_t sequence, std::string_view jpeg) {
  constexpr char kPictureKind = 2;
  std::string out = {kPictureKind, static_cast<char>(pane), 0, 0};
  for (int shift = 0; shift < 32; shift += 8) {
    out += static_cast<char>(static_cast<std::uint8_t>(sequence >> shift));
  }
  out += jpeg;
  return out;
}

}  // namespace sgs::viewer
