// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "rs2_abi.h"
#include "sgs/core/error.h"

namespace sgs::cameras::rs2 {

/// librealsense2, opened at run time and never closed: it has threads of its own.
struct Library {
  std::string path;
  int version = 0;  ///< 25004 is 2.50.4

#define SGS_RS2_MEMBER(result, name, parameters) result(*name) parameters = nullptr;
  SGS_RS2_FUNCTIONS(SGS_RS2_MEMBER)
#undef SGS_RS2_MEMBER

  /// "2.50.4".
  std::string version_text() const;

  /// Calls a function with an error as its last parameter; what the library says becomes an Error
  /// in words that help.
  template <class Function, class... Arguments>
  auto call(Function function, Arguments... arguments) const
      -> Result<decltype(function(arguments..., static_cast<rs2_error**>(nullptr)))> {
    rs2_error* error = nullptr;
    if constexpr (std::is_void_v<decltype(function(arguments..., &error))>) {
      function(arguments..., &error);
      if (error != nullptr) return tl::unexpected(taken(error));
      return {};
    } else {
      auto result = function(arguments..., &error);
      if (error != nullptr) return tl::unexpected(taken(error));
      return result;
    }
  }

 private:
  Error taken(rs2_error* error) const;
};

/// Looks for the library: $SGS_REALSENSE_LIBRARY alone where that is set, else librealsense2.so as
/// the loader finds it, else the newest librealsense2.so.2.* of the usual folders. Errors: none, a
/// file that is none, a function that is missing, a version before 2.31 or of another major number.
Result<std::shared_ptr<const Library>> open_library();

/// What people can do about a message of the library: a camera in use, one that may not be opened.
Error explained(const std::string& message);

}  // namespace sgs::cameras::rs2
