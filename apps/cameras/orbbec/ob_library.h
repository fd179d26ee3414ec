// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/camera_words.h"
#include "common/error_argument.h"
#include "ob_abi.h"

namespace sgs::cameras::ob {

/// libOrbbecSDK, opened at run time and never closed: it has threads of its own.
struct Library {
  std::string path;
  int version = 0;  ///< 20018 is 2.0.18

#define SGS_OB_MEMBER(result, name, parameters) result(*name) parameters = nullptr;
  SGS_OB_FUNCTIONS(SGS_OB_MEMBER)
#undef SGS_OB_MEMBER

  /// "2.0.18".
  std::string version_text() const;

  /// Calls a function with an error as its last parameter; what the library says becomes an Error
  /// in words that help.
  template <class Function, class... Arguments>
  auto call(Function function, Arguments... arguments) const
      -> Result<decltype(function(arguments..., static_cast<ob_error**>(nullptr)))> {
    return call_with_error<ob_error>([this](ob_error* error) { return taken(error); }, function,
                                     arguments...);
  }

 private:
  Error taken(ob_error* error) const;
};

/// Looks for the library: $SGS_ORBBEC_LIBRARY alone where that is set, else libOrbbecSDK.so as the
/// loader finds it, else the newest libOrbbecSDK.so.2* of the usual folders. Errors: none, a file
/// that is none, a function that is missing, a version before 2.0.18 or of another major number.
Result<std::shared_ptr<const Library>> open_library();

/// How these cameras are spoken of.
const CameraWords& words();

}  // namespace sgs::cameras::ob
