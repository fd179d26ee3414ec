// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "sgs/viewer/board.h"
#include "sgs/viewer/map_diff.h"
#include "sgs/viewer/messages.h"

namespace sgs::viewer {

/// A message ready to be sent; clients share the bytes.
struct Outgoing {
  bool text = true;
  std::shared_ptr<const std::string> bytes;
};

/// Encodes what several clients need only once: the newest state and the newest map step. Belongs
/// to the thread that serves.
class SharedEncoder {
 public:
  explicit SharedEncoder(const Board& board) : board_(board) {}
  const Board& board() const { return board_; }
  std::shared_ptr<const std::string> state(const Board::State& state, bool paused);
  /// Null when steps of large maps would take more than a fifth of this thread's time: later.
  std::shared_ptr<const MapStep> step(const ClientMapPtr& from, const FrameUpdate& update,
                                      double now_s);

 private:
  const Board& board_;
  std::uint64_t state_sequence_ = 0;
  std::shared_ptr<const std::string> state_;
  ClientMapPtr step_from_;
  map::SnapshotPtr step_map_;
  bool step_exact_ = false;
  std::shared_ptr<const MapStep> step_;
  double next_step_s_ = 0;
};

/// Decides what one client gets next. Nothing is queued: whenever the client has taken a message,
/// the next one is made from what is newest then, so that a slow client skips what it missed (but
/// for the path, which is sent without gaps) and holds at most one message and one map step.
class ClientStream {
 public:
  /// `hello` is sent first; `encoder` must outlive the stream.
  ClientStream(SharedEncoder& encoder, std::string hello);

  void subscribe(const SubscribeRequest& request);
  PaneSet panes() const { return panes_; }
  /// Keeps the newest picture of its pane; one that nobody asked for is ignored.
  void offer(Pane pane, std::shared_ptr<const std::string> message);
  /// The next message, if there is one; `now_s` on a monotonic clock.
  std::optional<Outgoing> next(double now_s, bool paused);
  /// True when the client has everything there is.
  bool up_to_date() const;

 private:
  std::optional<Outgoing> next_state(double now_s, bool paused);
  std::optional<Outgoing> next_picture();
  std::optional<Outgoing> next_map(double now_s);

  SharedEncoder& encoder_;
  std::string hello_;
  bool metrics_sent_ = false;
  std::uint64_t refinement_sent_ = 0, session_sent_ = 0;
  bool wants_map_ = false;
  PaneSet panes_ = 0;
  unsigned turn_ = 0;  // state, pictures and map take turns, so that none starves

  std::uint64_t state_sequence_ = 0, generation_ = 0;
  double next_state_s_ = 0;
  std::size_t path_known_ = 0;
  std::array<std::shared_ptr<const std::string>, kPanes> pictures_;

  ClientMapPtr map_;                     // what the client has
  bool map_exact_ = false;               // nothing was left out
  std::shared_ptr<const MapStep> step_;  // being sent
  std::size_t step_message_ = 0;
  double next_step_s_ = 0;
};

}  // namespace sgs::viewer
