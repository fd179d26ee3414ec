// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/stream/protocol.h"
#include "sgs/stream/stream_source.h"

// What a StreamSource needs of the operating system.
namespace sgs::stream {

/// A connection with somebody who sends, and what has come of it so far. It reads once each time
/// that it is told to.
class Link : public std::enable_shared_from_this<Link> {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Link(std::string who) : who_(std::move(who)) {}
  virtual ~Link() = default;

  /// Who is at the other end, for messages.
  const std::string& who() const { return who_; }
  Clock::time_point since() const { return since_; }
  StreamParser& parser() { return parser_; }
  /// Nothing more can come.
  bool closed() const { return closed_; }
  /// Begins to read, unless it does already; what comes goes to the parser.
  void read_on() {
    if (reading_ || closed_) return;
    reading_ = true;
    start_read();
  }
  /// A line for the other end; a pipe has none, and one who does not listen misses it.
  virtual void answer(const std::string& line) = 0;
  /// Why a link that is closed ended, where the other end is a program of ours that says so.
  virtual std::optional<Error> failure() { return std::nullopt; }
  /// Ends a read that goes on and the connection.
  virtual void close() = 0;

 protected:
  virtual void start_read() = 0;
  /// To be called when a read has ended; no bytes: the other end has closed it.
  void came(std::size_t bytes) {
    reading_ = false;
    if (bytes == 0) closed_ = true;
    parser_.push({buffer_.data(), bytes});
  }

  static constexpr std::size_t kRead_bytes = std::size_t{256} << 10;
  std::array<char, kRead_bytes> buffer_;

 private:
  std::string who_;
  Clock::time_point since_ = Clock::now();
  StreamParser parser_;
  bool reading_ = false, closed_ = false;
};

/// Where senders come in: a listening socket or a pipe.
class Entrance {
 public:
  static Result<std::unique_ptr<Entrance>> open(const Address& address);
  virtual ~Entrance() = default;

  /// For messages: "live:tcp://127.0.0.1:7447", with the port that was taken.
  virtual std::string name() const = 0;
  /// Whether nobody can come after the first one: standard input.
  virtual bool ends_with_link() const = 0;
  /// After a link was lost, or a guest turned away: lets the next sender in.
  virtual void open_again() = 0;
  /// What a program of ours has said on the way, for people.
  std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }
  /// Handles what happens, and returns after the first thing that did, or at `until`.
  virtual void run_until(Link::Clock::time_point until) = 0;
  /// Ends a run_until(), from any thread.
  virtual void wake() = 0;

  /// Those who have not greeted yet; at most a few.
  std::vector<std::shared_ptr<Link>>& guests() { return guests_; }

 protected:
  std::vector<std::shared_ptr<Link>> guests_;
  std::vector<std::string> notes_;
};

/// Starts the program for a camera, and starts it again whenever it has ended.
Result<std::unique_ptr<Entrance>> open_camera(const Address::Camera& camera);

}  // namespace sgs::stream
