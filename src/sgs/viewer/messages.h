// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "sgs/core/error.h"
#include "sgs/eval/metrics.h"
#include "sgs/viewer/board.h"

namespace sgs::viewer {

// The messages of docs/viewer.md, encoded and decoded; no state, no I/O.

std::string hello_message(const RunInfo& info);
/// The part of the path that starts at index `first`.
std::string path_message(std::size_t first, std::span<const PathPoint> points);
std::string state_message(const FrameUpdate& update, bool paused);
/// The scores of a finished run as lines of text; what was not measured is left out.
std::string metrics_message(const FinalWord& word);
std::string refinement_message(const RefinementNote& note);
std::string session_message(const SessionNote& note);
std::string error_message(std::string_view text);

/// The pictures a client can see.
enum class Pane : std::uint8_t { kColor = 0, kDepth = 1, kRender = 2, kError = 3, kView = 4 };
inline constexpr std::size_t kPanes = 5;
/// A set of panes, one bit each.
using PaneSet = unsigned;
constexpr PaneSet bit(Pane pane) { return 1u << static_cast<unsigned>(pane); }

/// `sequence`: frame index, for kView the number of the request.
std::string picture_message(Pane pane, std::uint32_t sequence, std::string_view jpeg);

struct ControlRequest {
  enum class Action {
    kPause,
    kResume,
    kStep,
    kRefine,
    kSave,
    kRecord,
    kStopRecording,
    kFinish,
    kFinishAndRefine,
    kStartAgain,
  } action;
};
struct SubscribeRequest {
  bool map = false;  ///< splats and points are the same data
  PaneSet panes = 0;
};
/// A picture of the map for the client's own camera.
struct ViewRequest {
  std::uint32_t sequence = 0;
  SE3 T_world_camera;
  double fov_y_rad = 1;
  int width = 0, height = 0;  ///< clamped to what the server is ready to render
};
using ClientRequest = std::variant<ControlRequest, SubscribeRequest, ViewRequest>;

/// Decodes what a client sent; an error says what is wrong with it. Never throws.
Result<ClientRequest> parse_request(std::string_view text);

/// Largest text a client may send, bytes.
// limit: WebSocket message to the viewer, bytes
inline constexpr std::size_t kMaxRequestBytes = 4096;

}  // namespace sgs::viewer
