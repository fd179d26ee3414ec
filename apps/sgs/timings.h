// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "sgs/core/stopwatch.h"

namespace sgs::app {

/// timings.json: per stage calls, total, median and 95th percentile in milliseconds.
std::string timings_json(const StageTimes& times);

/// Largest resident set of this process so far, bytes; 0 when the system does not tell.
std::int64_t peak_rss_bytes();

}  // namespace sgs::app
