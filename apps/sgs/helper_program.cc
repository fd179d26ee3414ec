// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "helper_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "sgs/run/exit_code.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

/// Beside this program or where packages keep it; empty where it is not installed.
fs::path find_helper(const std::string& name) {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& path : {here / name, here / "../libexec/sgs" / name}) {
    if (!error && ::access(path.c_str(), X_OK) == 0) return path;
  }
  return {};
}

void close_if_open(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

/// Both ends of a pipe, each closed unless it was taken.
struct Pipe {
  int read = -1, write = -1;
  bool open() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return false;
    read = ends[0];
    write = ends[1];
    return true;
  }
  ~Pipe() {
    close_if_open(read);
    close_if_open(write);
  }
};

}  // namespace

Result<HelperProgram> HelperProgram::start(Kind kind, const std::vector<std::string>& arguments) {
  const std::string program = find_helper(kind.name).string();
  if (program.empty()) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("{} need the program {}, which is not installed", kind.purpose, kind.name),
        kind.to_install);
  }
  Pipe input, output;
  if (!input.open() || !output.open()) {
    return fail(ErrorCode::kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, input.read, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, output.write, STDOUT_FILENO);
  pid_t child = -1;
  const int failure =
      ::posix_spawn(&child, program.c_str(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot start {}: {}", program, std::strerror(failure)));
  }
  return HelperProgram(std::move(kind), child, std::exchange(input.write, -1),
                       std::exchange(output.read, -1));
}

HelperProgram::~HelperProgram() {
  close_if_open(input_);
  close_if_open(output_);
  wait();
}

bool HelperProgram::feed(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(input_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

std::string HelperProgram::read_output() {
  std::string text;
  std::array<char, 4096> part{};
  ssize_t read = 0;
  while ((read = ::read(output_, part.data(), part.size())) > 0 || (read < 0 && errno == EINTR)) {
    if (read > 0) text.append(part.data(), static_cast<std::size_t>(read));
  }
  return text;
}

int HelperProgram::wait() {
  int status = 0;
  if (child_ < 0) return status;
  while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  return status;
}

Status HelperProgram::outcome(int status, const std::string& printed) const {
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) == SIGINT) return fail(ErrorCode::kInterrupted, "interrupted");
    return fail(ErrorCode::kInternal,
                fmt::format("{} was ended by signal {}", kind_.name, WTERMSIG(status)),
                kind_.to_fit);
  }
  const int code = WEXITSTATUS(status);
  if (code == run::kExitDone) return {};
  const auto line_end = printed.find('\n');
  std::string remedy = line_end == std::string::npos ? "" : printed.substr(line_end + 1);
  while (!remedy.empty() && remedy.back() == '\n') remedy.pop_back();
  return fail(code == run::kExitUsage ? ErrorCode::kInvalidArgument : ErrorCode::kIo,
              printed.substr(0, line_end), remedy);
}

Status HelperProgram::finish() {
  close_if_open(input_);
  const std::string printed = read_output();
  return outcome(wait(), printed);
}

}  // namespace sgs::app
