// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "sgs/core/error.h"
#include "sgs/run/exit_code.h"

namespace sgs::app {

using enum run::ExitCode;

/// Exit code for an error that ends the program.
int exit_code(const Error& error);
/// Prints the error to stderr and returns its exit code.
int report(const Error& error);

/// Says on stderr when the run in `folder` is not finished, so that nobody takes a part for the
/// whole. A folder whose state cannot be read is left to who reads the rest of it.
void note_state(const std::string& folder);

/// What the chosen subcommand does; called after parsing, its value is the exit code.
using Action = std::function<int()>;

// Each adds one subcommand; `action` is set when the user chose it.
void add_run(CLI::App& app, Action& action);
void add_refine(CLI::App& app, Action& action);
void add_calibrate(CLI::App& app, Action& action);
void add_eval(CLI::App& app, Action& action);
void add_render(CLI::App& app, Action& action);
void add_synth(CLI::App& app, Action& action);
void add_convert(CLI::App& app, Action& action);
void add_send(CLI::App& app, Action& action);
void add_camera_test(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_merge(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_view(CLI::App& app, Action& action);
void add_bench(CLI::App& app, Action& action);
void add_sweep(CLI::App& app, Action& action);

}  // namespace sgs::app
