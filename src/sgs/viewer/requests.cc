// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// What clients send: nothing of it is trusted.

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "sgs/viewer/messages.h"

namespace sgs::viewer {
namespace {

using Json = nlohmann::json;

constexpr int kMinSidePx = 16, kMaxWidthPx = 1280, kMaxHeightPx = 960;
constexpr double kMinFov = 0.05, kMaxFov = 2.8;  // rad
constexpr double kMaxCoordinate = 1e6;           // m

tl::unexpected<Error> bad(std::string message) {
  return fail(ErrorCode::kInvalidFormat, std::move(message), "see docs/viewer.md");
}

std::string text_field(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_string() ? it->get<std::string>() : std::string();
}

std::optional<double> number_field(const Json& json, const char* key) {
  const auto it = json.find(key);
  if (it == json.end() || !it->is_number()) return std::nullopt;
  const double value = it->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

Result<ClientRequest> parse_control(const Json& json) {
  using Action = ControlRequest::Action;
  static constexpr std::pair<std::string_view, Action> kActions[] = {
      {"pause", Action::kPause},
      {"resume", Action::kResume},
      {"step", Action::kStep},
      {"refine", Action::kRefine},
      {"save", Action::kSave},
      {"record", Action::kRecord},
      {"stop_recording", Action::kStopRecording},
      {"finish", Action::kFinish},
      {"finish_and_refine", Action::kFinishAndRefine},
      {"start_again", Action::kStartAgain}};
  const std::string action = text_field(json, "action");
  for (const auto& [name, value] : kActions) {
    if (action == name) return ControlRequest{value};
  }
  return bad("control.action is none that this server knows");
}

Result<ClientRequest> parse_subscribe(const Json& json) {
  SubscribeRequest request;
  const std::string map = text_field(json, "map");
  if (map != "splats" && map != "points" && map != "none" && json.contains("map")) {
    return bad("subscribe.map is neither splats, points nor none");
  }
  request.map = map == "splats" || map == "points";
  const auto panes = json.find("panes");
  if (panes == json.end()) return request;
  if (!panes->is_array()) return bad("subscribe.panes is no list");
  static constexpr std::pair<const char*, Pane> kNames[] = {{"color", Pane::kColor},
                                                            {"depth", Pane::kDepth},
                                                            {"render", Pane::kRender},
                                                            {"error", Pane::kError}};
  for (const Json& name : *panes) {
    const auto it = std::find_if(std::begin(kNames), std::end(kNames),
                                 [&](const auto& known) { return name == known.first; });
    if (it == std::end(kNames)) return bad("subscribe.panes has an unknown name");
    request.panes |= bit(it->second);
  }
  return request;
}

std::optional<SE3> parse_pose(const Json& json) {
  const auto pose = json.find("pose");
  if (pose == json.end() || !pose->is_array() || pose->size() != 7) return std::nullopt;
  double v[7];
  for (std::size_t k = 0; k < 7; ++k) {
    if (!(*pose)[k].is_number()) return std::nullopt;
    v[k] = (*pose)[k].get<double>();
    if (!(std::abs(v[k]) <= kMaxCoordinate)) return std::nullopt;
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(q.norm() > 1e-6)) return std::nullopt;
  return SE3(q, {v[0], v[1], v[2]});
}

Result<ClientRequest> parse_view(const Json& json) {
  ViewRequest request;
  const auto sequence = number_field(json, "seq"), fov = number_field(json, "fov_y");
  const auto width = number_field(json, "width"), height = number_field(json, "height");
  const auto pose = parse_pose(json);
  if (!sequence || !fov || !width || !height || !pose) {
    return bad("view needs seq, pose (7 numbers), fov_y, width and height");
  }
  if (*sequence < 0 || *sequence > 4294967295.0) return bad("view.seq does not fit 32 bits");
  request.sequence = static_cast<std::uint32_t>(*sequence);
  request.T_world_camera = *pose;
  request.fov_y_rad = std::clamp(*fov, kMinFov, kMaxFov);
  request.width = static_cast<int>(std::clamp<double>(*width, kMinSidePx, kMaxWidthPx));
  request.height = static_cast<int>(std::clamp<double>(*height, kMinSidePx, kMaxHeightPx));
  return request;
}

}  // namespace

Result<ClientRequest> parse_request(std::string_view text) {
  if (text.size() > kMaxRequestBytes) return bad("the message is too long");
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return bad("the message is no JSON object");
  const std::string type = text_field(json, "type");
  if (type == "control") return parse_control(json);
  if (type == "subscribe") return parse_subscribe(json);
  if (type == "view") return parse_view(json);
  return bad("the message's type is neither control, subscribe nor view");
}

}  // namespace sgs::viewer
