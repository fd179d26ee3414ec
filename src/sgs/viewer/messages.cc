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

/// A column of frames.csv as JSON: number, word, bool, list of six, or list of six axes; null where
/// nothing was measured.
struct ValueVisitor {
  Json& values;

  void operator()(const slam::FrameColumn& c,
                  const slam::StatusCell<const slam::FrameRecord>& cell) const {
    set(c, to_string(cell.record.status));
  }
  void operator()(const slam::FrameColumn& c, const std::array<double, 6>& six) const {
    const bool none = std::all_of(six.begin(), six.end(), [](double v) { return std::isnan(v); });
    set(c, none ? Json() : numbers(six));
  }
  void operator()(const slam::FrameColumn& c, const std::optional<Matrix6d>& axes) const {
    Json list;
    for (int k = 0; axes && k < 6; ++k) {
      const Vector6d axis = axes->col(k);
      list.push_back(numbers(axis));
    }
    set(c, std::move(list));
  }
  void operator()(const slam::FrameColumn& c, double value) const {
    // Time stamps are Unix times as a rule: seven digits are minutes then.
    set(c, c.key == "timestamp_s" ? Json(value) : number(value));
  }
  template <class T>
  void operator()(const slam::FrameColumn& c, const T& value) const {
    if constexpr (NamedEnum<T>) {
      set(c, to_string(value));
    } else {
      set(c, value);
    }
  }

  template <class Array>
  static Json numbers(const Array& array) {
    Json out = Json::array();
    for (const double value : array) out.push_back(number(value));
    return out;
  }
  void set(const slam::FrameColumn& c, Json value) const {
    values[std::string(c.key)] = std::move(value);
  }
};

/// What the values of a state message are: the list that the page shows in full.
Json columns_json() {
  Json columns = Json::array();
  const slam::FrameRecord any;
  slam::visit_columns(any, [&](const slam::FrameColumn& c, const auto&) {
    columns.push_back({{"key", c.key}, {"unit", c.unit}, {"meaning", c.meaning}});
  });
  return columns;
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

/// A direction where it is known, else null.
Json direction(const std::optional<Eigen::Vector3d>& d) {
  return d ? Json{number(d->x()), number(d->y()), number(d->z())} : Json();
}

}  // namespace

std::string hello_message(const RunInfo& info) {
  constexpr int kProtocol = 2;
  constexpr int kPictureAbove = 150000;  // what phones and software WebGL draw is far less
  const PinholeCamera& c = info.camera;
  Json json = {{"type", "hello"},
               {"protocol", kProtocol},
               {"version", info.version},
               {"input", info.input},
               {"tracker", info.tracker},
               {"preset", info.preset},
               {"live", info.live},
               {"refines", info.refines},
               {"session", info.session},
               {"records", info.records},
               {"starts_again", info.starts_again},
               {"up", direction(info.up)},
               {"frames_total", nullptr},
               {"picture_above", kPictureAbove}};
  json["columns"] = columns_json();
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
  const slam::FrameRecord& record = update.record;
  const std::size_t gaussians =
      update.map ? update.map->gaussians.size() : static_cast<std::size_t>(record.gaussians);
  Json values;
  slam::visit_columns(record, ValueVisitor{values});
  Json lost;
  if (record.status == tracker::TrackingStatus::kLost) {
    lost = alignment::explain(record.lost_reason);
  }
  return dump({{"type", "state"},
               {"frame", record.index},
               {"time", record.timestamp_s},
               {"status", to_string(record.status)},
               {"lost", std::move(lost)},
               {"values", std::move(values)},
               {"pose", Json::parse(pose_text(to_pose(update.T_world_camera)))},
               {"truth", update.truth ? Json::parse(pose_text(to_pose(*update.truth))) : Json()},
               {"map_version", update.map ? update.map->version : 0},
               {"gaussians", gaussians},
               {"map_ms", number(update.map_ms)},
               {"fps", number(update.fps)},
               {"paused", paused},
               {"finished", update.finished}});
}

std::string metrics_message(const FinalWord& word) {
  Json lines = Json::array();
  for (const eval::MetricLine& line : eval::metric_lines(word.metrics)) {
    if (line.value == "n/a") continue;
    lines.push_back({{"key", line.info.key},
                     {"group", line.info.group},
                     {"label", line.info.label},
                     {"value", line.value},
                     {"meaning", line.info.meaning},
                     {"main", line.info.rank != eval::Rank::kDetail}});
  }
  return dump({{"type", "metrics"}, {"lines", std::move(lines)}, {"up", direction(word.up)}});
}

std::string refinement_message(const RefinementNote& note) {
  return dump({{"type", "refinement"},
               {"running", note.running},
               {"share", number(note.share)},
               {"text", note.text}});
}

std::string session_message(const SessionNote& note) {
  Json warnings = Json::array();
  for (const SessionNote::Warning& w : note.warnings) {
    warnings.push_back({{"key", w.key}, {"text", w.text}});
  }
  return dump({{"type", "session"},
               {"at_camera_rate", note.at_camera_rate},
               {"dropped", note.dropped},
               {"left_out", note.left_out},
               {"camera_fps", number(note.camera_fps)},
               {"why_dropped", note.why_dropped},
               {"warnings", std::move(warnings)},
               {"trouble", note.trouble},
               {"recording", note.recording},
               {"recorded", note.recorded},
               {"recording_trouble", note.recording_trouble},
               {"saved", note.saved},
               {"refinable", note.refinable},
               {"ended", note.ended},
               {"downloads", note.downloads}});
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
