// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/camera_words.h"
#include "openni2_abi.h"

namespace sgs::cameras::openni2 {

/// libOpenNI2, opened at run time and never closed.
struct Library {
  std::string path;
  std::string version;  ///< "2.2.0.33"

#define SGS_OPENNI2_MEMBER(result, name, parameters) result(*name) parameters = nullptr;
  SGS_OPENNI2_FUNCTIONS(SGS_OPENNI2_MEMBER)
#undef SGS_OPENNI2_MEMBER

  /// Why something failed, in words that help.
  Error failure(const std::string& what) const;
};

/// Looks for the library: $SGS_OPENNI2_LIBRARY alone where that is set, else libOpenNI2.so as the
/// loader finds it, else the newest libOpenNI2.so.* of the usual folders, and starts it. Errors:
/// none, a file that is none, a function that is missing, another major version.
Result<std::shared_ptr<const Library>> open_library();

/// How these cameras are spoken of.
const CameraWords& words();

}  // namespace sgs::cameras::openni2
