// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Internal to server.cc, the one translation unit that includes Beast (it compiles slowly).

#include <atomic>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "sgs/core/stopwatch.h"
#include "sgs/viewer/board.h"
#include "sgs/viewer/client_stream.h"
#include "sgs/viewer/downloads.h"
#include "sgs/viewer/http_policy.h"
#include "sgs/viewer/picture_service.h"
#include "sgs/viewer/run_control.h"
#include "sgs/viewer/server.h"

namespace sgs::viewer::net {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using tcp = boost::asio::ip::tcp;
using boost::system::error_code;

class HttpConnection;
class ClientSession;

inline std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

/// What all connections share. But for downloads, board, control, pictures and client_count
/// everything here belongs to the thread that runs `io`.
struct Core {
  Core(const ServerOptions& o, const RunInfo& i)
      : options(o),
        hello(hello_message(i)),
        refines(i.refines),
        is_session(i.session),
        records(i.records),
        starts_again(i.starts_again),
        policy{o.names, {}},
        pictures(i.camera,
                 [this](Picture p) { asio::post(io, [this, p = std::move(p)] { deliver(p); }); }) {}

  /// Lets every client that is idle take what is new.
  void pump();
  void deliver(const Picture& picture);
  /// Tells the picture service which panes are wanted now.
  void update_panes();
  void handle(const ControlRequest& request);
  void handle_session(ControlRequest::Action action);

  ServerOptions options;
  std::string hello;
  bool refines, is_session, records, starts_again;
  HostPolicy policy;
  std::span<const EmbeddedFile> files = embedded_files();
  Downloads downloads;
  Board board;
  RunControl control;
  SharedEncoder encoder{board};
  std::uint64_t next_id = 1;
  std::map<std::uint64_t, std::weak_ptr<HttpConnection>> pending;  // oldest first
  std::map<std::uint64_t, std::weak_ptr<ClientSession>> clients;
  std::atomic<std::size_t> client_count{0};
  std::atomic<bool> wake_pending{false};
  asio::io_context io{1};
  PictureService pictures;  // last: its thread posts to `io`
};

}  // namespace sgs::viewer::net
