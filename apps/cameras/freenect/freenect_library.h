// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/camera_words.h"
#include "common/library_log.h"
#include "freenect_abi.h"

namespace sgs::cameras::freenect {

/// libfreenect, opened at run time and never closed.
struct Library {
  std::string path;  ///< the real one: only the file's name says the version

#define SGS_FREENECT_MEMBER(result, name, parameters) result(*name) parameters = nullptr;
  SGS_FREENECT_FUNCTIONS(SGS_FREENECT_MEMBER)
#undef SGS_FREENECT_MEMBER
};

/// Looks for the library: $SGS_FREENECT_LIBRARY alone where that is set, else libfreenect.so as the
/// loader finds it, else the newest libfreenect.so.0* of the usual folders. Errors: none, a file
/// that is none, a function that is missing.
Result<std::shared_ptr<const Library>> open_library();

/// How these cameras are spoken of.
const CameraWords& words();

/// What the library has logged: its functions return only that they failed.
LibraryLog& log();
Error last_failure(const std::string& what);

}  // namespace sgs::cameras::freenect
