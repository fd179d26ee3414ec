// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/camera_words.h"
#include "k4a_abi.h"

namespace sgs::cameras::k4a {

/// libk4a, opened at run time and never closed: it has threads of its own.
struct Library {
  std::string path;  ///< the real one: only the file's name says the version

#define SGS_K4A_MEMBER(result, name, parameters) result(*name) parameters = nullptr;
  SGS_K4A_FUNCTIONS(SGS_K4A_MEMBER)
#undef SGS_K4A_MEMBER
};

/// Looks for the library: $SGS_K4A_LIBRARY alone where that is set, else libk4a.so as the loader
/// finds it, else the newest libk4a.so.1* of the usual folders. Errors: none, a file that is none,
/// a function that is missing (before 1.2).
Result<std::shared_ptr<const Library>> open_library();

/// How these cameras are spoken of.
const CameraWords& words();

/// Why something of the library failed: what it has logged since the last call. Its functions
/// return only that they did.
Error last_failure(const std::string& what);

}  // namespace sgs::cameras::k4a
