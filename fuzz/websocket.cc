// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A whole server on a port of this machine. The first byte says whether the rest goes there as it
// is, or as WebSocket frames after a handshake that succeeds: pairs of a first byte (end, opcode)
// and a length, and so many bytes, which are masked as a browser would.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <memory>

#include "harness.h"
#include "sgs/viewer/server.h"

namespace {

using namespace sgs;

viewer::Server& server() {
  static const std::unique_ptr<viewer::Server> instance = [] {
    viewer::ServerOptions options;
    options.port = 0;
    viewer::RunInfo info;
    info.camera = {16, 12, 10, 10, 7.5, 5.5};
    auto started = viewer::Server::start(options, info);
    fuzz::require(started.has_value(), "the server starts");
    return std::move(*started);
  }();
  return *instance;
}

class Connection {
 public:
  Connection() : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server().port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{10, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    int connected = -1;
    do {
      connected = ::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    } while (connected != 0 && (errno == EINTR || errno == EALREADY));  // libFuzzer's clock
    // After an interruption the connection may have been made all the same.
    fuzz::require(connected == 0 || errno == EISCONN, "the server takes connections");
  }
  ~Connection() { ::close(fd_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void send(std::string_view bytes) {
    (void)!::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  /// Reads until `end` has come; all there is where the server closes first.
  void read_until(std::string_view end) {
    std::string text;
    while (end.empty() || text.find(end) == std::string::npos) {
      std::array<char, 4096> block{};
      const ssize_t got = ::recv(fd_, block.data(), block.size(), 0);
      if (got < 0 && errno == EINTR) continue;  // libFuzzer's clock
      if (got <= 0) {
        fuzz::require(got == 0 || errno == ECONNRESET, "the server answers or closes");
        return;
      }
      text.append(block.data(), static_cast<std::size_t>(got));
      if (text.size() > (1 << 20)) text.clear();
    }
  }
  void finish() { ::shutdown(fd_, SHUT_WR); }

 private:
  int fd_;
};

void send_frames(Connection& connection, std::string_view bytes) {
  std::string frames;
  while (bytes.size() >= 2) {
    const auto first = static_cast<unsigned char>(bytes[0]);
    auto length = static_cast<std::size_t>(static_cast<unsigned char>(bytes[1]));
    bytes.remove_prefix(2);
    length = std::min(length, bytes.size());
    frames += static_cast<char>(first);
    if (length < 126) {
      frames += static_cast<char>(0x80 | length);
    } else {
      frames += static_cast<char>(0x80 | 126);
      frames += static_cast<char>(length >> 8);
      frames += static_cast<char>(length & 0xff);
    }
    frames += std::string(4, '\0');  // a mask that changes nothing
    frames += bytes.substr(0, length);
    bytes.remove_prefix(length);
  }
  connection.send(frames);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Choice input(data, size);
  Connection connection;
  if (input.number % 2 == 0) {
    connection.send(input.rest);
  } else {
    connection.send(
        "GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    connection.read_until("\r\n\r\n");
    send_frames(connection, input.rest);
  }
  connection.finish();
  connection.read_until("");
  return 0;
}
