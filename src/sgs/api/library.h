// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/api/export.h"

namespace sgs::api {

/// Version of the library that runs, "major.minor.patch".
SGS_API std::string version();

/// Sends the library's log lines of a level and above to stderr: "info", "warning", "error"; "off"
/// is how it starts. Throws kInvalidArgument for other words.
SGS_API void log_to_stderr(const std::string& level);

}  // namespace sgs::api
