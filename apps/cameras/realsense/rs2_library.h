// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/camera_words.h"
#include "common/error_argument.h"
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
    return call_with_error<rs2_error>([this](rs2_error* error) { return taken(error); }, function,
                                      arguments...);
  }

 private:
  Error taken(rs2_error* error) const;
};

/// Looks for the library: $SGS_REALSENSE_LIBRARY alone where that is set, else librealsense2.so as
/// the loader finds it, else the newest librealsense2.so.2.* of the usual folders. Errors: none, a
/// file that is none, a function that is missing, a version before 2.31 or of another major number.
Result<std::shared_ptr<const Library>> open_library();

/// How these cameras are spoken of.
const CameraWords& words();

}  // namespace sgs::cameras::rs2
