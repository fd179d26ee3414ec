// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/core/error.h"

namespace sgs::io {

/// The error of a system call on a file: what could not be done ("read", "write"), why, and what
/// helps. `code` is its errno.
tl::unexpected<Error> system_error(const char* action, const std::filesystem::path& path, int code);

}  // namespace sgs::io
