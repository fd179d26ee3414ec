// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "sgs/api/export.h"

namespace sgs::api {

/// What kind of thing went wrong.
enum class ErrorCode {
  kNotFound,         ///< a file or folder that was asked for does not exist
  kInvalidFormat,    ///< a file exists but its content cannot be understood
  kInvalidArgument,  ///< an argument, a configuration value or a combination makes no sense
  kUnknownKey,       ///< a key that no parameter has; the message names the nearest one
  kIo,               ///< reading or writing failed (permissions, full disk, device)
  kUnsupported,      ///< valid, but not something this build can handle
  kBusy,             ///< another thread is at work on this object
  kInterrupted,      ///< a Stop was requested
  kInternal,         ///< memory ran out, or the library made a mistake
};

/// The one exception that the library throws. what() is a printable paragraph: message and remedy.
class SGS_API Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message, const std::string& remedy = {});
  ~Error() override;

  ErrorCode code() const { return code_; }
  /// What happened, naming the file, key or argument.
  const std::string& message() const { return message_; }
  /// What can be done about it; may be empty.
  const std::string& remedy() const { return remedy_; }

 private:
  ErrorCode code_;
  std::string message_, remedy_;
};

}  // namespace sgs::api
