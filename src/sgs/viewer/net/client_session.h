// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "sgs/viewer/net/core.h"
#include "sgs/viewer/net/received_bytes.h"

namespace sgs::viewer::net {

/// Messages that may come now: fills at a fixed rate up to a bound.
class TokenBucket {
 public:
  TokenBucket(double per_s, double most, double now_s)
      : per_s_(per_s), most_(most), tokens_(most), last_s_(now_s) {}
  bool take(double now_s) {
    tokens_ = std::min(most_, tokens_ + per_s_ * (now_s - last_s_));
    last_s_ = now_s;
    if (tokens_ < 1) return false;
    tokens_ -= 1;
    return true;
  }

 private:
  double per_s_, most_, tokens_, last_s_;
};

/// One WebSocket: reads requests, and whenever the last message has been taken sends what the
/// client's stream says is next.
class ClientSession : public std::enable_shared_from_this<ClientSession> {
 public:
  ClientSession(Core& core, tcp::socket socket)
      : core_(core),
        id_(core.next_id++),
        ws_(std::move(socket)),
        stream_(core.encoder, core.hello),
        bucket_(core.options.limits.requests_per_s, 2 * core.options.limits.requests_per_s,
                wall_time_s()) {}
  ~ClientSession() { leave(); }
  ClientSession(const ClientSession&) = delete;
  ClientSession& operator=(const ClientSession&) = delete;

  template <class Request>
  void start(Request request) {
    core_.clients[id_] = weak_from_this();
    core_.client_count = core_.clients.size();
    constexpr int kSendBuffer = 1 << 20;
    error_code ignored;
    lowest().socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    lowest().socket().set_option(tcp::no_delay(true), ignored);
    const auto& limits = core_.options.limits;
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = milliseconds(limits.header_timeout_s);
    timeout.idle_timeout = milliseconds(3 * limits.send_timeout_s);
    timeout.keep_alive_pings = true;
    ws_.set_option(timeout);
    ws_.read_message_max(kMaxRequestBytes);
    ws_.auto_fragment(false);
    ws_.control_callback([this](websocket::frame_type, beast::string_view) {
      flooding_ = flooding_ || !bucket_.take(wall_time_s());
      seen_bytes_ = received();
    });
    auto shared = std::make_shared<Request>(std::move(request));
    ws_.async_accept(*shared, [self = shared_from_this(), shared](error_code error) {
      if (error) return self->drop();
      self->open_ = true;
      self->read();
      self->pump();
    });
  }

  /// Sends the next message unless one is on its way.
  void pump() {
    if (!open_ || outgoing_) return;
    auto next = stream_.next(wall_time_s(), core_.control.paused());
    if (!next) return;
    outgoing_ = next->bytes;
    sending_since_s_ = wall_time_s();
    ws_.text(next->text);
    ws_.async_write(asio::buffer(*outgoing_),
                    [self = shared_from_this()](error_code error, std::size_t) {
                      self->outgoing_.reset();
                      if (error) return self->drop();
                      self->pump();
                    });
  }

  /// Drops a client that does not take its message or does not finish its good-bye in time.
  void check_deadline(double now_s) {
    const bool stuck = outgoing_ && now_s - sending_since_s_ > core_.options.limits.send_timeout_s;
    constexpr double kGoodbye_s = 1;
    // Many times what a message may hold, and still no message: fragments without end.
    // limit: bytes on a WebSocket without a message, bytes
    constexpr std::uint64_t kMostPerMessage = 16 * kMaxRequestBytes;
    flooding_ = flooding_ || received() - seen_bytes_ > kMostPerMessage;
    if (stuck || flooding_ || (closing_since_s_ > 0 && now_s - closing_since_s_ > kGoodbye_s))
      drop();
  }

  void close(websocket::close_code code, std::string_view reason) {
    if (!open_) return drop();
    open_ = false;
    closing_since_s_ = wall_time_s();
    ws_.async_close({code, beast::string_view(reason.data(), reason.size())},
                    [self = shared_from_this()](error_code) { self->drop(); });
  }

  std::uint64_t id() const { return id_; }
  ClientStream& stream() { return stream_; }
  bool up_to_date() const { return !open_ || (!outgoing_ && stream_.up_to_date()); }

 private:
  using Stream = beast::basic_stream<tcp, asio::any_io_executor, ReceivedBytes>;

  Stream& lowest() { return beast::get_lowest_layer(ws_); }
  std::uint64_t received() { return lowest().rate_policy().count(); }

  void leave() {
    if (core_.clients.erase(id_) == 0) return;
    core_.client_count = core_.clients.size();
    core_.pictures.forget(id_);
    core_.update_panes();
  }

  void drop() {
    open_ = false;
    lowest().close();
    leave();
  }

  void read() {
    ws_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->drop();
      self->on_message();
    });
  }

  void on_message() {
    seen_bytes_ = received();
    if (!open_) return;
    if (!bucket_.take(wall_time_s())) {
      return close(websocket::close_code::policy_error, "too many messages");
    }
    const auto bytes = buffer_.data();
    const auto request = ws_.got_text()
                             ? parse_request({static_cast<const char*>(bytes.data()), bytes.size()})
                             : Result<ClientRequest>(
                                   fail(ErrorCode::kInvalidFormat, "binary messages mean nothing"));
    buffer_.consume(buffer_.size());
    if (!request) return close(websocket::close_code::policy_error, request.error().message);
    if (const auto* control = std::get_if<ControlRequest>(&*request)) core_.handle(*control);
    if (const auto* view = std::get_if<ViewRequest>(&*request)) {
      core_.pictures.request_view(id_, *view);
    }
    if (const auto* subscribe = std::get_if<SubscribeRequest>(&*request)) {
      stream_.subscribe(*subscribe);
      core_.update_panes();
      pump();
    }
    read();
  }

  Core& core_;
  std::uint64_t id_;
  websocket::stream<Stream> ws_;
  ClientStream stream_;
  TokenBucket bucket_;
  beast::flat_buffer buffer_;
  std::shared_ptr<const std::string> outgoing_;  // being sent
  double sending_since_s_ = 0, closing_since_s_ = 0;
  std::uint64_t seen_bytes_ = 0;  // received when the last message or control frame was complete
  bool open_ = false, flooding_ = false;
};

}  // namespace sgs::viewer::net
