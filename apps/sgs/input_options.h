// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "sgs/runfolder/run_config.h"

namespace sgs::app {

/// The recording itself: one input, or the files of one recording.
CLI::Option* add_input_argument(CLI::App& app, run::InputSpec& input, const std::string& meaning);
/// The same and, as the last argument, where it goes to, which is called `output_name`.
CLI::Option* add_input_and_output(CLI::App& app, run::InputSpec& input, std::string& output,
                                  const std::string& output_name, const std::string& meaning);

/// Options of recordings, for every command that opens one: calibration, unit, and what to take
/// from a bag.
void add_recording_options(CLI::App& app, run::InputSpec& input);
/// What a command that tracks an input may be told about it: the above, --config, --tracker, --set,
/// --frames, --trajectory, --synth-seed.
void add_tracking_options(CLI::App& app, run::InputSpec& input, run::ConfigSources& config);

}  // namespace sgs::app
