// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/viewer/net/client_session.h"
#include "sgs/viewer/net/core.h"

namespace sgs::viewer::net {

/// One HTTP request and its answer, or the way into a WebSocket. Closes afterwards: what is not
/// kept open cannot pile up.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Core& core, tcp::socket socket)
      : core_(core), id_(core.next_id++), stream_(std::move(socket)) {
    error_code ignored;
    local_address_ = stream_.socket().local_endpoint(ignored).address().to_string();
    parser_.header_limit(core.options.limits.header_bytes);
    parser_.body_limit(0);
  }
  ~HttpConnection() { core_.pending.erase(id_); }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void start() {
    core_.pending[id_] = weak_from_this();
    stream_.expires_after(milliseconds(core_.options.limits.header_timeout_s));
    http::async_read_header(
        stream_, buffer_, parser_,
        [self = shared_from_this()](error_code error, std::size_t) { self->on_header(error); });
  }
  /// Makes room for others.
  void evict() {
    core_.pending.erase(id_);
    stream_.close();
  }

 private:
  void on_header(error_code error) {
    if (error == http::error::header_limit) return refuse(431, "The header is too long.");
    if (error == http::error::body_limit) return refuse(413, "No request here has a body.");
    if (error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message) {
      return refuse(400, "This is no HTTP request.");
    }
    if (error) return;
    const auto& request = parser_.get();
    const auto text = [](beast::string_view view) {
      return std::string_view(view.data(), view.size());
    };
    RequestFacts facts;
    facts.method = text(request.method_string());
    facts.target = text(request.target());
    if (request.count(http::field::host) == 1) facts.host = text(request[http::field::host]);
    if (request.count(http::field::origin) > 0) facts.origin = text(request[http::field::origin]);
    facts.upgrade = websocket::is_upgrade(request);
    const Verdict verdict = judge(facts, core_.policy, local_address_, core_.files);
    head_only_ = facts.method == "HEAD";
    if (verdict.websocket) return become_client();
    if (verdict.status != 200) return refuse(verdict.status, verdict.reason);
    if (!verdict.download.empty()) return send_file(verdict.download);
    if (verdict.file == nullptr) return answer(200, "text/plain; charset=utf-8", "ok\n");
    answer(200, content_type(verdict.file->path), verdict.file->bytes);
  }

  void become_client() {
    if (core_.clients.size() >= core_.options.limits.clients) {
      return refuse(503, "There are too many viewers already.");
    }
    std::make_shared<ClientSession>(core_, stream_.release_socket())->start(parser_.release());
  }

  void refuse(int status, std::string_view reason) {
    refusal_ = std::string(reason) + "\n";
    answer(status, "text/plain; charset=utf-8", refusal_);
  }

  static beast::string_view view(std::string_view text) { return {text.data(), text.size()}; }

  template <class Response>
  static void head(Response& response, int status, std::string_view type, std::uint64_t bytes) {
    response.result(static_cast<unsigned>(status));
    response.version(11);
    for (const auto& [name, value] : security_headers()) response.set(view(name), view(value));
    response.set(http::field::content_type, view(type));
    response.keep_alive(false);
    response.content_length(bytes);
  }

  /// A file of the run, in pieces: a client that goes on taking them may take its time.
  void send_file(std::string_view name) {
    const std::string file = core_.downloads.find(name).string();
    error_code error = http::make_error_code(http::error::end_of_stream);
    if (!file.empty()) file_.body().open(file.c_str(), beast::file_mode::scan, error);
    if (error) return refuse(404, "There is no such file of the run.");
    head(file_, 200, content_type(name), file_.body().size());
    file_.set(http::field::content_disposition,
              "attachment; filename=\"" + std::string(name) + "\"");
    file_serializer_.emplace(file_);
    if (head_only_) file_serializer_->split(true);
    send_piece();
  }

  void send_piece() {
    stream_.expires_after(milliseconds(core_.options.limits.response_timeout_s));
    const auto sent = [self = shared_from_this()](error_code error, std::size_t) {
      if (!error && !self->head_only_ && !self->file_serializer_->is_done()) {
        return self->send_piece();
      }
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    };
    if (head_only_) {
      http::async_write_header(stream_, *file_serializer_, sent);
    } else {
      http::async_write_some(stream_, *file_serializer_, sent);
    }
  }

  void answer(int status, std::string_view content_type, std::string_view body) {
    head(response_, status, content_type, body.size());
    if (!head_only_) response_.body() = beast::span<const char>(body.data(), body.size());
    stream_.expires_after(milliseconds(core_.options.limits.response_timeout_s));
    serializer_.emplace(response_);
    const auto done = [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    };
    if (head_only_) {
      http::async_write_header(stream_, *serializer_, done);
    } else {
      http::async_write(stream_, *serializer_, done);
    }
  }

  using Body = http::span_body<const char>;

  Core& core_;
  std::uint64_t id_;
  beast::tcp_stream stream_;
  std::string local_address_, refusal_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<Body> response_;
  std::optional<http::response_serializer<Body>> serializer_;
  http::response<http::file_body> file_;
  std::optional<http::response_serializer<http::file_body>> file_serializer_;
  bool head_only_ = false;
};

}  // namespace sgs::viewer::net
