// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "export_mesh.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include "sgs/run/exit_code.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

/// sgs-mesh, beside this program or where packages keep it; empty where it is not installed.
fs::path find_mesh_program() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& path : {here / "sgs-mesh", here / "../libexec/sgs/sgs-mesh"}) {
    if (!error && ::access(path.c_str(), X_OK) == 0) return path;
  }
  return {};
}

/// What a program did: its status as waitpid() gives it, and what it printed.
struct Finished {
  int status = 0;
  std::string output;
};

Result<Finished> run_program(const std::vector<std::string>& words) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    return fail(ErrorCode::kIo, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t child = 0;
  const int failure =
      ::posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  Finished finished;
  if (failure == 0) {
    std::array<char, 4096> part{};
    ssize_t read = 0;
    while ((read = ::read(ends[0], part.data(), part.size())) > 0 || (read < 0 && errno == EINTR)) {
      if (read > 0) finished.output.append(part.data(), static_cast<std::size_t>(read));
    }
    while (::waitpid(child, &finished.status, 0) < 0 && errno == EINTR) {
    }
  }
  ::close(ends[0]);
  if (failure != 0) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot start {}: {}", words[0], std::strerror(failure)));
  }
  return finished;
}

/// What sgs-mesh says of its end.
Status outcome_of(const Finished& finished) {
  if (WIFSIGNALED(finished.status)) {
    if (WTERMSIG(finished.status) == SIGINT) return fail(ErrorCode::kInterrupted, "interrupted");
    return fail(ErrorCode::kInternal,
                fmt::format("sgs-mesh was ended by signal {}", WTERMSIG(finished.status)),
                "is there enough memory? A larger --voxel needs less");
  }
  const int code = WEXITSTATUS(finished.status);
  if (code == run::kExitDone) return {};
  const auto line_end = finished.output.find('\n');
  std::string remedy = line_end == std::string::npos ? "" : finished.output.substr(line_end + 1);
  while (!remedy.empty() && remedy.back() == '\n') remedy.pop_back();
  return fail(code == run::kExitUsage ? ErrorCode::kInvalidArgument : ErrorCode::kIo,
              finished.output.substr(0, line_end), remedy);
}

}  // namespace

Status export_mesh(const std::string& run, const MeshOptions& options, const fs::path& path) {
  const fs::path program = find_mesh_program();
  if (program.empty()) {
    return fail(
        ErrorCode::kUnsupported, "meshes need the program sgs-mesh, which is not installed",
        "install the package sgs-mesh; for a build from source install libopenvdb-dev, then "
        "configure and build again");
  }
  std::vector<std::string> words = {program.string(),
                                    run,
                                    path.string(),
                                    "--voxel",
                                    fmt::format("{}", options.voxel_m),
                                    "--threads",
                                    fmt::format("{}", options.threads)};
  if (options.measured) words.emplace_back("--measured-depth");
  SGS_ASSIGN_OR_RETURN(const Finished finished, run_program(words));
  return outcome_of(finished);
}

}  // namespace sgs::app
