// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::app {

/// A program that stands beside `sgs` because it links what is heavy and seldom needed. `sgs` feeds
/// its standard input and reads what it prints: nothing, or on failure a message and a remedy, a
/// line each.
class HelperProgram {
 public:
  struct Kind {
    std::string name;        ///< of the file, beside `sgs` or where packages keep it
    std::string purpose;     ///< "meshes", as the subject of "... need the program ..."
    std::string to_install;  ///< remedy where the program is not installed
    std::string to_fit;      ///< remedy where it ended without a word: it had too little memory
  };

  /// Fails where the program is not installed or cannot be started.
  static Result<HelperProgram> start(Kind kind, const std::vector<std::string>& arguments);
  HelperProgram(HelperProgram&& other) noexcept
      : kind_(std::move(other.kind_)),
        child_(std::exchange(other.child_, -1)),
        input_(std::exchange(other.input_, -1)),
        output_(std::exchange(other.output_, -1)) {}
  HelperProgram& operator=(HelperProgram&&) = delete;
  /// Waits for the program if finish() did not.
  ~HelperProgram();

  /// Writes to its standard input; false once it reads no more: finish() then tells why.
  bool feed(std::span<const std::byte> bytes);
  /// Ends its input, waits for its end and tells what it made of it.
  Status finish();

 private:
  HelperProgram(Kind kind, pid_t child, int input, int output)
      : kind_(std::move(kind)), child_(child), input_(input), output_(output) {}
  std::string read_output();
  int wait();
  Status outcome(int status, const std::string& printed) const;

  Kind kind_;
  pid_t child_ = -1;
  int input_ = -1, output_ = -1;
};

}  // namespace sgs::app
