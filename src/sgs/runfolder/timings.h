// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "sgs/core/stopwatch.h"
#include "sgs/runfolder/input_event.h"

namespace sgs::run {

/// timings.json: a tree of stages, each with calls, total, median and 95th percentile in
/// milliseconds, and its parts under "children".
std::string timings_json(const StageTimes& times);
/// The run on a time line, one row per thread, in Chrome's trace event format (chrome://tracing,
/// ui.perfetto.dev); `events` are marks across all of it.
std::string chrome_trace(const StageTimes& times, std::span<const InputEvent> events = {});

}  // namespace sgs::run
