// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace sgs::app {

enum class LogStart { kAnew, kAppend };

/// Sends the library's log to `file` (when given) and its warnings to stderr (unless `quiet`).
void setup_logging(const std::filesystem::path& file, bool quiet, LogStart start = LogStart::kAnew);

}  // namespace sgs::app
