// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/link.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>
#include <utility>

#include "sgs/io/system_error.h"
#include "sgs/stream/asio_entrance.h"

namespace sgs::stream {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

class TcpLink final : public Link {
 public:
  TcpLink(tcp::socket socket, std::string who) : Link(std::move(who)), socket_(std::move(socket)) {
    error_code ignored;
    socket_.non_blocking(true, ignored);  // an answer must not wait for who does not listen
  }
  void answer(const std::string& line) override {
    error_code ignored;
    asio::write(socket_, asio::buffer(line + "\n"), ignored);
  }
  void close() override {
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_both, ignored);
    socket_.close(ignored);
  }

 private:
  void start_read() override {
    socket_.async_read_some(asio::buffer(buffer_), [this, self = shared_from_this()](
                                                       const error_code& error, std::size_t bytes) {
      came(error ? 0 : bytes);
    });
  }

  tcp::socket socket_;
};

/// What is no pipe but a file never makes anybody wait.
class FileLink final : public Link {
 public:
  FileLink(asio::io_context& context, int descriptor, std::string who)
      : Link(std::move(who)), context_(context), descriptor_(descriptor) {}
  ~FileLink() override { ::close(descriptor_); }
  void answer(const std::string&) override {}
  void close() override {}

 private:
  void start_read() override {
    asio::post(context_, [this, self = shared_from_this()] {
      const ssize_t bytes = ::read(descriptor_, buffer_.data(), buffer_.size());
      came(bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
    });
  }

  asio::io_context& context_;
  int descriptor_;
};

class TcpEntrance final : public AsioEntrance {
 public:
  ~TcpEntrance() override { guests_.clear(); }

  Status listen(const Address& address) {
    error_code error;
    const auto ip =
        asio::ip::make_address(address.host == "localhost" ? "127.0.0.1" : address.host, error);
    if (error) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("'{}' is no address to listen on", address.host),
                  "for example live:tcp://127.0.0.1:7447");
    }
    if (!ip.is_loopback()) {
      return fail(ErrorCode::kUnsupported,
                  fmt::format("{}: a stream is taken from this machine only", address.host),
                  fmt::format("listen on 127.0.0.1 and let the other machine come through ssh: "
                              "`ssh -L {0}:127.0.0.1:{0} THIS_MACHINE`, there",
                              address.port));
    }
    const tcp::endpoint endpoint(ip, address.port);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      return fail(
          ErrorCode::kIo,
          fmt::format("cannot listen on {}:{}: {}", address.host, address.port, error.message()),
          "choose another port");
    }
    accept();
    return {};
  }

  std::string name() const override {
    error_code ignored;
    const auto endpoint = acceptor_.local_endpoint(ignored);
    return fmt::format("live:tcp://{}:{}", endpoint.address().to_string(), endpoint.port());
  }
  bool ends_with_link() const override { return false; }
  void open_again() override {}

 private:
  void accept() {
    acceptor_.async_accept([this](const error_code& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) welcome(std::move(socket));
      accept();
    });
  }

  /// Who comes when too many wait already is turned away at once.
  void welcome(tcp::socket socket) {
    constexpr std::size_t kMostGuests = 8;
    error_code ignored;
    const auto from = socket.remote_endpoint(ignored);
    auto link = std::make_shared<TcpLink>(
        std::move(socket), fmt::format("{}:{}", from.address().to_string(), from.port()));
    if (guests_.size() >= kMostGuests) {
      link->answer("refused too many connections");
      link->close();
      return;
    }
    link->read_on();
    guests_.push_back(std::move(link));
  }

  tcp::acceptor acceptor_{context_};
};

/// A named pipe, a file, or standard input.
class PipeEntrance final : public AsioEntrance {
 public:
  explicit PipeEntrance(std::string path) : path_(std::move(path)) {}
  ~PipeEntrance() override {
    guests_.clear();
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  Status open_first() {
    struct stat about {};
    const bool standard = path_ == "-";
    const int descriptor =
        standard ? ::dup(STDIN_FILENO) : ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0 || ::fstat(descriptor, &about) != 0) {
      return io::system_error("read", standard ? "standard input" : path_, errno);
    }
    fifo_ = !standard && S_ISFIFO(about.st_mode);
    if (S_ISDIR(about.st_mode)) {
      ::close(descriptor);
      return fail(ErrorCode::kInvalidArgument, fmt::format("{} is a folder", path_),
                  "live: takes a pipe; give a recording's folder without live:");
    }
    if (fifo_) {
      descriptor_ = descriptor;
      wait_for_writer();
    } else if (S_ISREG(about.st_mode)) {
      admit(std::make_shared<FileLink>(context_, descriptor, name()));
    } else {
      admit(std::make_shared<PipeLink>(context_, descriptor, name()));
    }
    return {};
  }

  std::string name() const override { return path_ == "-" ? "standard input" : "live:" + path_; }
  bool ends_with_link() const override { return !fifo_; }
  void open_again() override {
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    wait_for_writer();
  }

 private:
  void admit(std::shared_ptr<Link> link) {
    link->read_on();
    guests_.push_back(std::move(link));
  }

  /// A pipe that nobody writes to looks as if it had ended, so it is looked at now and then.
  void wait_for_writer() {
    constexpr auto kPeriod = std::chrono::milliseconds(100);
    timer_.expires_after(kPeriod);
    timer_.async_wait([this](const error_code& error) {
      if (error || descriptor_ < 0) return;
      char first = 0;
      const ssize_t bytes = ::read(descriptor_, &first, 1);
      if (bytes == 0) return wait_for_writer();
      auto link = std::make_shared<PipeLink>(context_, std::exchange(descriptor_, -1), name());
      if (bytes == 1) link->parser().push({&first, 1});
      admit(std::move(link));
    });
  }

  std::string path_;
  bool fifo_ = false;
  int descriptor_ = -1;  // of a named pipe that nobody writes to yet
  asio::steady_timer timer_{context_};
};

}  // namespace

Result<std::unique_ptr<Entrance>> Entrance::open(const Address& address) {
  if (address.camera) return open_camera(*address.camera);
  if (!address.host.empty()) {
    auto entrance = std::make_unique<TcpEntrance>();
    SGS_RETURN_IF_ERROR(entrance->listen(address));
    return entrance;
  }
  auto entrance = std::make_unique<PipeEntrance>(address.path);
  SGS_RETURN_IF_ERROR(entrance->open_first());
  return entrance;
}

}  // namespace sgs::stream
