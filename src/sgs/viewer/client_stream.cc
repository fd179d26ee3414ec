// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/client_stream.h"

#include <algorithm>
#include <utility>

#include "sgs/core/stopwatch.h"

namespace sgs::viewer {
namespace {

constexpr std::size_t kPathChunk = 2048;
constexpr double kMapInterval_s = 0.5;  // between map steps of one client
// Between its states: more than a screen shows would only take time from an offline run.
constexpr double kStateInterval_s = 0.02;

}  // namespace

std::shared_ptr<const std::string> SharedEncoder::state(const Board::State& state, bool paused) {
  if (!state_ || state_sequence_ != state.sequence) {
    state_ = std::make_shared<const std::string>(state_message(*state.update, paused));
    state_sequence_ = state.sequence;
  }
  return state_;
}

std::shared_ptr<const MapStep> SharedEncoder::step(const ClientMapPtr& from,
                                                   const FrameUpdate& update, double now_s) {
  if (!step_ || step_from_ != from || step_map_ != update.map || step_exact_ != update.finished) {
    constexpr double kRestFactor = 5;
    if (now_s < next_step_s_ && !update.finished) return nullptr;
    const double start_s = wall_time_s();
    step_ = std::make_shared<const MapStep>(map_step(from, *update.map, update.finished));
    step_from_ = from;
    step_map_ = update.map;
    step_exact_ = update.finished;
    next_step_s_ = now_s + kRestFactor * (wall_time_s() - start_s);
  }
  return step_;
}

ClientStream::ClientStream(SharedEncoder& encoder, std::string hello)
    : encoder_(encoder), hello_(std::move(hello)) {}

void ClientStream::subscribe(const SubscribeRequest& request) {
  panes_ = request.panes;
  wants_map_ = request.map;
  if (wants_map_) return;
  map_.reset();
  step_.reset();
}

void ClientStream::offer(Pane pane, std::shared_ptr<const std::string> message) {
  if (pane == Pane::kView || (panes_ & bit(pane)) != 0) {
    pictures_[static_cast<std::size_t>(pane)] = std::move(message);
  }
}

std::optional<Outgoing> ClientStream::next(double now_s, bool paused) {
  if (!hello_.empty()) {
    return Outgoing{true, std::make_shared<const std::string>(std::exchange(hello_, {}))};
  }
  // Rare and short: before what a busy run has without end.
  if (encoder_.board().session_number() != session_sent_) {
    const auto [number, note] = encoder_.board().session();
    session_sent_ = number;
    return Outgoing{true, std::make_shared<const std::string>(session_message(note))};
  }
  for (int i = 0; i < 3; ++i) {
    std::optional<Outgoing> out;
    switch (turn_++ % 3) {
      case 0:
        out = next_state(now_s, paused);
        break;
      case 1:
        out = next_picture();
        break;
      default:
        out = next_map(now_s);
    }
    if (out) return out;
  }
  if (const auto [number, note] = encoder_.board().refinement(); number != refinement_sent_) {
    refinement_sent_ = number;
    return Outgoing{true, std::make_shared<const std::string>(refinement_message(note))};
  }
  if (!metrics_sent_) {
    if (const auto word = encoder_.board().final_word()) {
      metrics_sent_ = true;
      return Outgoing{true, std::make_shared<const std::string>(metrics_message(*word))};
    }
  }
  return std::nullopt;
}

std::optional<Outgoing> ClientStream::next_state(double now_s, bool paused) {
  const Board::State state = encoder_.board().state();
  if (state.sequence == state_sequence_ || !state.update) return std::nullopt;
  if (now_s < next_state_s_ && !state.update->finished) return std::nullopt;
  if (state.generation != generation_) {
    generation_ = state.generation;
    metrics_sent_ = false;  // a replay may go on with another map
    if (std::exchange(path_known_, 0) > 0) {
      return Outgoing{true, std::make_shared<const std::string>(path_message(0, {}))};
    }
  }
  const auto frame = static_cast<std::size_t>(state.update->record.index);
  if (path_known_ < frame) {
    const auto points =
        encoder_.board().path(path_known_, std::min(kPathChunk, frame - path_known_));
    if (!points.empty()) {
      auto text = path_message(path_known_, points);
      path_known_ += points.size();
      return Outgoing{true, std::make_shared<const std::string>(std::move(text))};
    }
  }
  path_known_ = std::max(path_known_, frame + 1);
  state_sequence_ = state.sequence;
  next_state_s_ = now_s + kStateInterval_s;
  return Outgoing{true, encoder_.state(state, paused)};
}

std::optional<Outgoing> ClientStream::next_picture() {
  for (auto& picture : pictures_) {
    if (picture) return Outgoing{false, std::exchange(picture, nullptr)};
  }
  return std::nullopt;
}

std::optional<Outgoing> ClientStream::next_map(double now_s) {
  if (!wants_map_) return std::nullopt;
  if (!step_) {
    const Board::State state = encoder_.board().state();
    if (!state.update || !state.update->map || now_s < next_step_s_) return std::nullopt;
    const bool newer = !map_ || map_->version != state.update->map->version;
    if (!newer && (map_exact_ || !state.update->finished)) return std::nullopt;
    step_ = encoder_.step(map_, *state.update, now_s);
    if (!step_) return std::nullopt;
    step_message_ = 0;
    next_step_s_ = now_s + kMapInterval_s;
    map_exact_ = state.update->finished;
  }
  Outgoing out{false, std::make_shared<const std::string>(map_message(*step_, step_message_))};
  if (++step_message_ == map_message_count(*step_)) {
    map_ = step_->to;
    step_.reset();
  }
  return out;
}

bool ClientStream::up_to_date() const {
  const Board::State state = encoder_.board().state();
  const bool map_missing = wants_map_ && state.update && state.update->map &&
                           (!map_ || map_->version != state.update->map->version ||
                            (state.update->finished && !map_exact_));
  return hello_.empty() && !step_ && !map_missing && state.sequence == state_sequence_ &&
         encoder_.board().session_number() == session_sent_ &&
         (metrics_sent_ || !encoder_.board().final_word());
}

}  // namespace sgs::viewer
