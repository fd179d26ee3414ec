// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "sgs/run/execute.h"
#include "sgs/run/score.h"

namespace sgs::run {

/// What a whole run is asked for beside its input and its configuration.
struct WholeRunOptions {
  RunOptions run;
  ScoreOptions score;    ///< with the threads of the run, whatever stands here
  bool pictures = true;  ///< compare the map with the recording, too
};

/// A run with all that follows it.
struct WholeRun {
  RunResult result;  ///< its map is the refined one where that was asked for
  Scores scores;
};

/// InputSpec::calibration where the input is to be calibrated from itself, before the run.
inline constexpr const char* kCalibrateFirst = "auto";

/// Whether run_whole() can do that; to be asked before anything is opened. To calibrate first, and
/// to refine at the end (`refine.steps_per_frame`), the recording is gone through once more: frames
/// that come only once are refused, and so is refining a run at the sensor's rate.
Status check_whole(const InputSpec& spec, const RunConfig& config, const RunOptions& options);

/// open_input() for run_whole(): an input that is to be calibrated first is opened as it is.
Result<Input> open_run_input(InputSpec spec, int threads, const std::stop_token& stop = {});

/// A run from an open input to its scores: calibration where `spec` asks for it (kCalibrateFirst),
/// execute(), then refinement in the same folder if `refine.steps_per_frame` is not 0, then scores.
/// Scores and the report are the caller's to write (report::save_scores()). A run that was stopped,
/// or has no map, is not refined; its pictures, and those of a stream, are not scored. Warnings
/// about the input and doubts about its units go to the log. Fails where one of these steps does;
/// what was computed until then is in the folder.
Result<WholeRun> run_whole(Input& input, InputSpec spec, const RunConfig& config,
                           const WholeRunOptions& options, RunFolder& folder,
                           RunObserver& observer = RunObserver::nobody(),
                           const std::stop_token& stop = {});

}  // namespace sgs::run
