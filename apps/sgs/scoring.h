// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "sgs/run/score.h"

namespace sgs::app {

/// --lpips-weights and --lpips-stride.
void add_score_options(CLI::App& sub, run::ScoreOptions& options);
/// run::score_run() with a progress bar, until Ctrl-C. Says where the recording is gone.
Result<run::Scores> score_with_progress(const run::Run& run, const run::ScoreOptions& options,
                                        bool quiet);

/// Says what could not be written where it belongs, and where it went; the exit code.
int report_failures(const run::RunFolder& folder);

}  // namespace sgs::app
