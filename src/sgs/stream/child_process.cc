// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

namespace sgs::stream {
namespace {

using Ends = std::array<Descriptor, 2>;

Result<Ends> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    return fail(ErrorCode::kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return Ends{Descriptor(ends[0]), Descriptor(ends[1])};
}

/// A socket, not a pipe: writing to one that nobody reads is an error without a signal.
Result<Ends> make_socket_pair() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return fail(ErrorCode::kIo, fmt::format("cannot make a socket: {}", std::strerror(errno)));
  }
  return Ends{Descriptor(ends[0]), Descriptor(ends[1])};
}

/// The attributes of a child: a group of its own, signals as any program finds them.
class Attributes {
 public:
  Attributes() {
    ::posix_spawnattr_init(&value_);
    ::posix_spawnattr_setflags(&value_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    ::posix_spawnattr_setpgroup(&value_, 0);
    sigset_t defaults;
    ::sigemptyset(&defaults);
    ::sigaddset(&defaults, SIGPIPE);
    ::posix_spawnattr_setsigdefault(&value_, &defaults);
  }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  ~Attributes() { ::posix_spawnattr_destroy(&value_); }
  const posix_spawnattr_t* get() const { return &value_; }

 private:
  posix_spawnattr_t value_{};
};

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    if (number_ >= 0) ::close(number_);
    number_ = other.release();
  }
  return *this;
}

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

Result<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                         const std::vector<std::string>& arguments) {
  SGS_ASSIGN_OR_RETURN(Ends input, make_socket_pair());
  SGS_ASSIGN_OR_RETURN(Ends output, make_pipe());
  SGS_ASSIGN_OR_RETURN(Ends errors, make_pipe());
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, input[1].get(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, output[1].get(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, errors[1].get(), STDERR_FILENO);
  const Attributes attributes;
  pid_t child = -1;
  const int failure =
      ::posix_spawn(&child, program.c_str(), &actions, attributes.get(), words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot start {}: {}", program.string(), std::strerror(failure)));
  }
  ChildProcess started(child);
  started.input_ = std::move(input[0]);
  started.output = std::move(output[0]);
  started.errors = std::move(errors[0]);
  return started;
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : output(std::move(other.output)),
      errors(std::move(other.errors)),
      input_(std::move(other.input_)),
      child_(std::exchange(other.child_, -1)),
      status_(other.status_) {}

ChildProcess::~ChildProcess() {
  constexpr std::chrono::milliseconds kPatience(2000), kSure(5000);
  if (child_ < 0) return;
  close_input();
  output = Descriptor();
  errors = Descriptor();
  if (wait_for(kPatience)) return;
  ::kill(child_, SIGKILL);
  wait_for(kSure);
}

void ChildProcess::tell(const std::string& line) const {
  const std::string text = line + "\n";
  [[maybe_unused]] const auto sent =
      ::send(input_.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

std::optional<int> ChildProcess::wait_for(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kLook(5);
  const auto until = std::chrono::steady_clock::now() + time;
  while (!status_) {
    int status = 0;
    const pid_t done = ::waitpid(child_, &status, WNOHANG);
    if (done == child_) {
      status_ = status;
    } else if (done < 0 && errno != EINTR) {
      status_ = 0;  // somebody else has reaped it
    } else if (std::chrono::steady_clock::now() >= until) {
      break;
    } else {
      std::this_thread::sleep_for(kLook);
    }
  }
  return status_;
}

}  // namespace sgs::stream
