// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/logger.h>

#include <memory>
#include <vector>

#include "sgs/core/format.h"

namespace sgs {

/// The library's logger. Silent until an application installs sinks: the library never prints.
spdlog::logger& log();

/// Replaces the sinks of the library's logger (a terminal, the run folder's log.txt, ...).
void set_log_sinks(std::vector<spdlog::sink_ptr> sinks);

}  // namespace sgs
