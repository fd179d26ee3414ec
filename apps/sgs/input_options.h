// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "sgs/run/input.h"

namespace sgs::app {

/// Options of recordings, for every command that opens one: calibration, unit, and what to take
/// from a bag.
void add_recording_options(CLI::App& app, run::InputSpec& input);

}  // namespace sgs::app
