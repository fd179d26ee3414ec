// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::stream {

/// An open file, closed once.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();

  int get() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

/// A program that was started, in a process group of its own: Ctrl-C on the terminal is for its
/// parent, which tells it. Its standard output is a pipe, and its input and errors are.
class ChildProcess {
 public:
  static Result<ChildProcess> start(const std::filesystem::path& program,
                                    const std::vector<std::string>& arguments);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Closes its input, and ends it if it does not end by itself within two seconds.
  ~ChildProcess();

  /// Both do not block.
  Descriptor output, errors;
  /// Sends a line to its input; lost where it does not listen.
  void tell(const std::string& line) const;
  /// How it ended, as of waitpid(); empty: not within this time.
  std::optional<int> wait_for(std::chrono::milliseconds time);
  void close_input() { input_ = Descriptor(); }

 private:
  explicit ChildProcess(pid_t child) : child_(child) {}

  Descriptor input_;
  pid_t child_;
  std::optional<int> status_;
};

}  // namespace sgs::stream
