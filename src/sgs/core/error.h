// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "sgs/core/format.h"

namespace sgs {

/// What kind of thing went wrong; the command line maps kinds to exit codes.
enum class ErrorCode {
  kNotFound,         ///< a file, folder or key that was asked for does not exist
  kInvalidFormat,    ///< a file exists but its content cannot be understood
  kInvalidArgument,  ///< a config value, option or combination makes no sense
  kIo,               ///< reading or writing failed (permissions, full disk, device)
  kUnsupported,      ///< valid, but not something this build can handle
  kInterrupted,      ///< the user asked to stop
  kInternal,         ///< memory ran out, or the program made a mistake
};

/// Expected failure of files, config, formats and devices. `message` names the file, line or key;
/// `remedy` says what the user can do about it.
struct Error {
  ErrorCode code = ErrorCode::kInvalidArgument;
  std::string message;
  std::string remedy;

  /// One printable paragraph: message, and the remedy where there is one.
  std::string text() const {
    return remedy.empty() ? message : fmt::format("{} ({})", message, remedy);
  }
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = tl::expected<void, Error>;

/// Makes the error branch of a Result: `return fail(ErrorCode::kIo, "...", "...");`
inline tl::unexpected<Error> fail(ErrorCode code, std::string message, std::string remedy = {}) {
  return tl::unexpected<Error>(Error{code, std::move(message), std::move(remedy)});
}

/// The exception in hand as an Error; to be called in a catch block only.
Error current_error();

/// Thrown when a caller breaks a documented contract: a bug, never bad input.
class ContractViolation : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

}  // namespace sgs

/// Throws ContractViolation with file and line when `condition` is false; NaN comparisons fail too.
#define SGS_CHECK(condition, message)                                                \
  do {                                                                               \
    if (!(condition))                                                                \
      throw ::sgs::ContractViolation(                                                \
          fmt::format("{}:{}: {} [{}]", __FILE__, __LINE__, (message), #condition)); \
  } while (false)

/// Evaluates a Result expression; on failure returns its error, else binds the value to `lhs`.
#define SGS_CONCAT_INNER(a, b) a##b
#define SGS_CONCAT(a, b) SGS_CONCAT_INNER(a, b)
#define SGS_ASSIGN_OR_RETURN(lhs, expression) \
  SGS_ASSIGN_OR_RETURN_IMPL(SGS_CONCAT(sgs_result_, __LINE__), lhs, expression)
#define SGS_ASSIGN_OR_RETURN_IMPL(tmp, lhs, expression)       \
  auto tmp = (expression);                                    \
  if (!tmp) return tl::unexpected<::sgs::Error>(tmp.error()); \
  lhs = std::move(*tmp)
#define SGS_RETURN_IF_ERROR(expression)                                   \
  do {                                                                    \
    if (auto sgs_status = (expression); !sgs_status)                      \
      return tl::unexpected<::sgs::Error>(std::move(sgs_status.error())); \
  } while (false)
