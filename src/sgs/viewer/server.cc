// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/server.h"

#include <fmt/format.h>

#include <future>
#include <thread>

#include "sgs/core/log.h"
#include "sgs/core/low_priority.h"
#include "sgs/viewer/net/client_session.h"
#include "sgs/viewer/net/core.h"
#include "sgs/viewer/net/http_connection.h"

namespace sgs::viewer {
namespace net {
namespace {

/// Pumping and dropping clients changes the list: work on a copy.
std::vector<std::shared_ptr<ClientSession>> sessions(const Core& core) {
  std::vector<std::shared_ptr<ClientSession>> all;
  for (const auto& [id, weak] : core.clients) {
    if (auto session = weak.lock()) all.push_back(std::move(session));
  }
  return all;
}

}  // namespace

void Core::pump() {
  for (const auto& session : sessions(*this)) session->pump();
}

void Core::deliver(const Picture& picture) {
  for (const auto& session : sessions(*this)) {
    if (picture.pane == Pane::kView && picture.client != session->id()) continue;
    session->stream().offer(picture.pane, picture.message);
    session->pump();
  }
}

void Core::update_panes() {
  PaneSet all = 0;
  for (const auto& session : sessions(*this)) all |= session->stream().panes();
  pictures.set_panes(all);
}

void Core::handle(const ControlRequest& request) {
  switch (request.action) {
    case ControlRequest::Action::kPause:
      control.pause();
      break;
    case ControlRequest::Action::kResume:
      control.resume();
      break;
    case ControlRequest::Action::kStep:
      control.step();
      break;
    case ControlRequest::Action::kRefine:
      // While it goes on: that it ends.
      if (refines || board.refinement().second.running) control.ask_refinement();
      break;
    default:
      if (is_session) handle_session(request.action);
  }
  board.touch();
  pump();
}

// A run without a session, and a replay, have nothing to finish.
void Core::handle_session(ControlRequest::Action action) {
  using Action = ControlRequest::Action;
  switch (action) {
    case Action::kSave:
      return control.ask_save();
    case Action::kRecord:
      if (!records) return;
      return control.set_recording(true);
    case Action::kStopRecording:
      return control.set_recording(false);
    case Action::kFinish:
      return control.finish(AfterRun::kNothing);
    case Action::kFinishAndRefine:
      return control.finish(AfterRun::kRefine);
    case Action::kStartAgain:
      if (!starts_again) return;
      return control.finish(AfterRun::kStartAgain);
    default:
      return;
  }
}

}  // namespace net

using net::error_code;
using net::asio::ip::tcp;

struct Server::Impl {
  Impl(const ServerOptions& options, const RunInfo& info)
      : core(options, info), acceptor(core.io), accept_pause(core.io), ticker(core.io) {}
  // Sessions that die with the queue of `io` must not call into what is gone already.
  ~Impl() { core.clients.clear(); }

  Status listen();
  void accept();
  void on_socket(tcp::socket socket);
  void tick();
  void run();
  void wake();
  void stop();

  net::Core core;
  tcp::acceptor acceptor;
  net::asio::steady_timer accept_pause, ticker;
  double posted_wake_s = 0;  // only of the thread that posts
  double alone_since_s = 0;
  double stopping_since_s = 0;  // > 0: good-byes are being said
  std::string url;
  int port = 0;
  std::thread thread;
};

Status Server::Impl::listen() {
  const ServerOptions& o = core.options;
  error_code error;
  const auto address =
      net::asio::ip::make_address(o.address == "localhost" ? "127.0.0.1" : o.address, error);
  if (error || o.port < 0 || o.port > 65535) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the viewer cannot listen at '{}', port {}", o.address, o.port),
                "give a numeric address of this machine and a port up to 65535");
  }
  const tcp::endpoint endpoint(address, static_cast<std::uint16_t>(o.port));
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(net::asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(net::asio::socket_base::max_listen_connections, error);
  if (error) {
    return fail(ErrorCode::kIo,
                fmt::format("the viewer cannot listen at {}, port {}: {}", o.address, o.port,
                            error.message()),
                "choose another port; 0 takes any free one");
  }
  port = acceptor.local_endpoint().port();
  const std::string host = address.is_unspecified() ? "localhost"
                           : address.is_v6()        ? fmt::format("[{}]", address.to_string())
                                                    : address.to_string();
  url = fmt::format("http://{}:{}/", host, port);
  // Beyond this machine a port is no secret: only who has seen the address may watch and pause.
  if (!address.is_loopback()) {
    core.policy.token = o.token.empty() ? make_token() : o.token;
    url += "?token=" + core.policy.token;
  }
  return {};
}

void Server::Impl::accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (!error) {
      on_socket(std::move(socket));
      return accept();
    }
    // Out of descriptors or memory: others need a moment to go.
    accept_pause.expires_after(std::chrono::milliseconds(100));
    accept_pause.async_wait([this](error_code stopped) {
      if (!stopped) accept();
    });
  });
}

void Server::Impl::on_socket(tcp::socket socket) {
  while (core.pending.size() >= core.options.limits.pending) {
    const auto oldest = core.pending.begin();
    if (const auto connection = oldest->second.lock()) {
      connection->evict();
    } else {
      core.pending.erase(oldest);
    }
  }
  std::make_shared<net::HttpConnection>(core, std::move(socket))->start();
}

// Many times a second: clients that wait for the next state or map, deadlines, a run paused by
// nobody.
void Server::Impl::tick() {
  const double now_s = wall_time_s();
  for (const auto& session : net::sessions(core)) {
    session->check_deadline(now_s);
    session->pump();
  }
  if (!core.clients.empty()) alone_since_s = now_s;
  const bool alone = now_s - alone_since_s > core.options.limits.resume_after_s;
  if (alone && core.options.resume_when_alone && core.control.paused()) {
    log().info("viewer: nobody is watching; the paused run goes on");
    core.control.resume();
  }
  constexpr double kGoodbye_s = 0.5;
  if (stopping_since_s > 0 && (core.clients.empty() || now_s - stopping_since_s > kGoodbye_s)) {
    core.io.stop();
    return;
  }
  const int pause_ms = stopping_since_s > 0 ? 10 : core.clients.empty() ? 100 : 25;
  ticker.expires_after(std::chrono::milliseconds(pause_ms));
  ticker.async_wait([this](error_code stopped) {
    if (!stopped) tick();
  });
}

void Server::Impl::run() {
  lower_thread_priority(5);
  while (true) {
    try {
      core.io.run();
      return;
    } catch (const std::exception& error) {
      // One connection's trouble (memory, most likely) is not the others'.
      log().error("viewer: {}", error.what());
    }
  }
}

void Server::Impl::wake() {
  if (core.wake_pending.exchange(true)) return;
  net::asio::post(core.io, [this] {
    core.wake_pending = false;
    core.pump();
  });
}

void Server::Impl::stop() {
  net::asio::post(core.io, [this] {
    error_code ignored;
    acceptor.close(ignored);
    accept_pause.cancel();
    for (const auto& session : net::sessions(core)) {
      session->close(net::websocket::close_code::going_away, "the program ends");
    }
    stopping_since_s = wall_time_s();
    ticker.cancel();
    tick();
  });
  thread.join();
}

Result<std::unique_ptr<Server>> Server::start(const ServerOptions& options, const RunInfo& info) {
  auto impl = std::make_unique<Impl>(options, info);
  SGS_RETURN_IF_ERROR(impl->listen());
  impl->accept();
  impl->tick();
  impl->thread = std::thread([raw = impl.get()] { raw->run(); });
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Server::~Server() { impl_->stop(); }

int Server::port() const { return impl_->port; }
std::string Server::url() const { return impl_->url; }
std::string Server::token() const { return impl_->core.policy.token; }
std::size_t Server::clients() const { return impl_->core.client_count; }
RunControl& Server::control() { return impl_->core.control; }

void Server::post(FrameUpdate update) {
  auto shared = std::make_shared<const FrameUpdate>(std::move(update));
  const bool finished = shared->finished;
  impl_->core.pictures.offer(shared);
  impl_->core.board.post(std::move(shared));
  // What comes faster than this waits for the next tick: every wake interrupts the run.
  constexpr double kWakeInterval_s = 0.02;
  const double now_s = wall_time_s();
  if (!finished && now_s - impl_->posted_wake_s < kWakeInterval_s) return;
  impl_->posted_wake_s = now_s;
  impl_->wake();
}

void Server::update_map(map::SnapshotPtr map) {
  const auto state = impl_->core.board.state();
  if (!state.update || !map || map == state.update->map) return;
  FrameUpdate again = *state.update;
  again.map = std::move(map);
  post(std::move(again));
}

void Server::finish(map::SnapshotPtr final_map) {
  const auto state = impl_->core.board.state();
  if (!state.update) return;
  FrameUpdate last = *state.update;
  last.map = std::move(final_map);
  last.finished = true;
  post(std::move(last));
}

void Server::restart() { impl_->core.board.restart(); }

void Server::touch() {
  impl_->core.board.touch();
  impl_->wake();
}

void Server::set_refinement(RefinementNote note) {
  impl_->core.board.set_refinement(std::move(note));
  impl_->wake();
}

void Server::set_session(SessionNote note) {
  impl_->core.board.set_session(std::move(note));
  impl_->wake();
}

void Server::offer_file(const std::string& name, const std::filesystem::path& file) {
  impl_->core.downloads.offer(name, file);
}

void Server::set_final_word(FinalWord word) {
  impl_->core.board.set_final_word(std::move(word));
  impl_->wake();
}

void Server::drain(double timeout_s) {
  const double end_s = wall_time_s() + timeout_s;
  while (wall_time_s() < end_s) {
    auto answer = std::make_shared<std::promise<bool>>();
    auto all = answer->get_future();
    net::asio::post(impl_->core.io, [this, answer] {
      bool done = true;
      for (const auto& session : net::sessions(impl_->core)) done = done && session->up_to_date();
      answer->set_value(done);
    });
    const auto left = std::chrono::duration<double>(std::max(0.0, end_s - wall_time_s()));
    if (all.wait_for(left) == std::future_status::ready && all.get()) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace sgs::viewer
