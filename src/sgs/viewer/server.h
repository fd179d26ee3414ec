// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/eval/metrics.h"
#include "sgs/viewer/frame_update.h"
#include "sgs/viewer/run_control.h"

namespace sgs::viewer {

/// What keeps a hostile or clumsy client from hurting anybody.
struct ServerLimits {
  // limit: viewers at once
  std::size_t clients = 64;  ///< WebSockets at once; more are refused with 503
  // limit: HTTP connections at once
  std::size_t pending = 128;  ///< connections still busy with HTTP; the oldest gives way
  // limit: header of an HTTP request, bytes
  std::uint32_t header_bytes = 8192;
  // limit: time to send an HTTP request, s
  double header_timeout_s = 5;  ///< to send a whole request
  // limit: time to take an HTTP answer, s
  double response_timeout_s = 30;  ///< to take a whole file
  // limit: time to take a WebSocket message, s
  double send_timeout_s = 10;  ///< to take one WebSocket message; then the client is dropped
  // limit: WebSocket messages of a viewer per second
  double requests_per_s = 200;  ///< WebSocket messages of one client, sustained; twice that
                                ///< at once
  double resume_after_s = 10;   ///< a paused run goes on this long after the last client left
};

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< numeric, or "localhost"
  int port = 8765;                    ///< 0 = any free one
  std::vector<std::string> names;     ///< further values of the Host header that are accepted
  std::string token = {};             ///< beyond this machine; empty: a new one is made
  bool resume_when_alone = true;      ///< see ServerLimits::resume_after_s
  ServerLimits limits;
};

/// Shows a run to browsers: HTTP for the page, a WebSocket for what happens (docs/viewer.md); what
/// clients wish of a run is in control(). One thread serves, another one renders pictures; both
/// have low priority. The thread that posts never waits for either. All functions are thread-safe.
class Server {
 public:
  /// Listens; fails when the address is not ours or the port is taken.
  static Result<std::unique_ptr<Server>> start(const ServerOptions& options, const RunInfo& info);
  /// Says good-bye to the clients (a fraction of a second at most) and stops.
  ~Server();

  int port() const;
  /// What to type into a browser on this machine.
  std::string url() const;
  /// What pages of beyond this machine need; empty on this machine.
  std::string token() const;
  /// Connected WebSockets.
  std::size_t clients() const;

  /// Shows a new state: appends its pose to the path and replaces the newest one.
  void post(FrameUpdate update);
  /// The newest update once more with this map, unless it is the one that is shown: mapping goes on
  /// for a moment after a frame, and while a run is paused no other one comes. Null changes
  /// nothing.
  void update_map(map::SnapshotPtr map);
  /// The newest update once more, as finished and with the final map.
  void finish(map::SnapshotPtr final_map);
  /// A replay starts again from its first frame.
  void restart();
  /// Sends the state again: the control was used from this side.
  void touch();
  /// How the refinement fares that a client asked for (RunInfo::refines, RunControl).
  void set_refinement(RefinementNote note);
  /// How the session fares.
  void set_session(SessionNote note);
  /// From now on GET /download/NAME gives what the file holds when it is asked for; "" takes the
  /// name back.
  void offer_file(const std::string& name, const std::filesystem::path& file);
  /// The run is finished.
  void set_final_word(FinalWord word);
  RunControl& control();
  /// Waits until every client has everything, at most so long.
  void drain(double timeout_s);

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgs::viewer
