// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/sender.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cerrno>
#include <csignal>
#include <utility>

#include "sgs/io/system_error.h"

namespace sgs::stream {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Waits until a descriptor is ready for `events`.
Status wait_for(int descriptor, short events, const std::string& who, const std::stop_token& stop) {
  constexpr int kLook_ms = 200, kLooks = 10;
  for (int looks = 0;; ++looks) {
    pollfd wanted = {descriptor, events, 0};
    if (::poll(&wanted, 1, kLook_ms) > 0) return {};
    if (looks >= kLooks && stop.stop_requested()) {
      return fail(ErrorCode::kInterrupted,
                  fmt::format("interrupted while {} took nothing more", who));
    }
  }
}

/// Writes everything to a descriptor that does not block; errno's error where that fails.
Status write_all(int descriptor, std::string_view bytes, const std::string& who,
                 const std::stop_token& stop) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      SGS_RETURN_IF_ERROR(wait_for(descriptor, POLLOUT, who, stop));
    } else if (errno != EINTR) {
      return io::system_error("write to", who, errno);
    }
  }
  return {};
}

/// Writing to who went away is an error, not the end of the program.
void survive_broken_pipes() { std::signal(SIGPIPE, SIG_IGN); }

class TcpSender final : public Sender {
 public:
  explicit TcpSender(std::stop_token stop) : stop_(std::move(stop)) {}

  Status connect(const Address& address, const Hello& hello) {
    who_ = fmt::format("{}:{}", address.host, address.port);
    error_code error;
    const auto ip =
        asio::ip::make_address(address.host == "localhost" ? "127.0.0.1" : address.host, error);
    if (error) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("'{}' is no address to connect to", address.host),
                  "give an IP address, for example live:tcp://127.0.0.1:7447");
    }
    socket_.connect({ip, address.port}, error);
    if (error) {
      return fail(ErrorCode::kNotFound, fmt::format("{}: {}", who_, error.message()),
                  fmt::format("start the other end first: `sgs run live:tcp://{}`", who_));
    }
    socket_.native_non_blocking(true, error);
    SGS_RETURN_IF_ERROR(write(encode_hello(hello)));
    return expect("ok");
  }

  Status send(const Packet& packet) override {
    SGS_ASSIGN_OR_RETURN(const std::string bytes, encode_packet(packet));
    return write(bytes);
  }

  Status finish() override {
    SGS_RETURN_IF_ERROR(write(kEndMark));
    return expect("done");
  }

 private:
  Status write(std::string_view bytes) {
    const Status written = write_all(socket_.native_handle(), bytes, who_, stop_);
    if (written || written.error().code == ErrorCode::kInterrupted) return written;
    // Why it was closed may stand in what was not read yet.
    const Status answer = expect("ok");
    return answer ? written : answer;
  }

  /// One line from the other end.
  Status expect(const std::string& word) {
    constexpr std::size_t kLongestAnswer = 1000;
    std::string line;
    while (line.size() < kLongestAnswer) {
      SGS_RETURN_IF_ERROR(wait_for(socket_.native_handle(), POLLIN, who_, stop_));
      char next = 0;
      const ssize_t read = ::recv(socket_.native_handle(), &next, 1, 0);
      if (read < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (read <= 0) {
        return fail(ErrorCode::kIo, fmt::format("{} broke off the connection", who_),
                    "its own messages and log say why; start it again, then this");
      }
      if (next == '\n') break;
      line += next;
    }
    if (line == word) return {};
    return fail(ErrorCode::kIo, fmt::format("{} answered: {}", who_, line));
  }

  std::stop_token stop_;
  asio::io_context context_;
  tcp::socket socket_{context_};
  std::string who_;
};

/// Standard output, a named pipe or a file.
class PipeSender final : public Sender {
 public:
  explicit PipeSender(std::stop_token stop) : stop_(std::move(stop)) {}
  ~PipeSender() override {
    if (descriptor_ > STDERR_FILENO) ::close(descriptor_);
  }

  Status open(const Address& address, const Hello& hello) {
    path_ = address.path;
    if (path_ == "-") {
      descriptor_ = STDOUT_FILENO;
      path_ = "standard output";
    } else {
      // A pipe that nobody reads cannot be opened: one may try again.
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
      if (descriptor_ < 0 && errno == ENXIO) {
        return fail(ErrorCode::kNotFound, fmt::format("{}: nobody reads this pipe", path_),
                    fmt::format("start the other end first: `sgs run live:{}`", path_));
      }
      if (descriptor_ < 0) return io::system_error("write", path_, errno);
    }
    return write_all(descriptor_, encode_hello(hello), path_, stop_);
  }

  Status send(const Packet& packet) override {
    SGS_ASSIGN_OR_RETURN(const std::string bytes, encode_packet(packet));
    return write_all(descriptor_, bytes, path_, stop_);
  }
  Status finish() override { return write_all(descriptor_, kEndMark, path_, stop_); }

 private:
  std::stop_token stop_;
  std::string path_;
  int descriptor_ = -1;
};

}  // namespace

Result<std::unique_ptr<Sender>> Sender::open(const Address& address, const Hello& hello,
                                             const std::stop_token& stop) {
  survive_broken_pipes();
  if (!address.host.empty()) {
    auto sender = std::make_unique<TcpSender>(stop);
    SGS_RETURN_IF_ERROR(sender->connect(address, hello));
    return sender;
  }
  auto sender = std::make_unique<PipeSender>(stop);
  SGS_RETURN_IF_ERROR(sender->open(address, hello));
  return sender;
}

}  // namespace sgs::stream
