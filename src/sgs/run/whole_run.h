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

/// Whether run_whole() can do that; to be asked before anything is opened. A map is refined from
/// the recording, gone through once more: frames that come only once, and runs at the sensor's
/// rate, are refused where `refine.steps_per_frame` asks for it.
Status check_whole(const InputSpec& spec, const RunConfig& config, const RunOptions& options);

/// A run from its first frame to its scores: execute(), then refinement in the same folder if
/// `refine.steps_per_frame` is not 0, then scores. Scores and the report are the caller's to write
/// (report::save_scores()). A run that was stopped, or has no map, is not refined; its pictures,
/// and those of a stream, are not scored. Doubts about the units of the input go to the log. Fails
/// where check_whole() or execute() do, and where refinement does.
Result<WholeRun> run_whole(Input& input, const InputSpec& spec, const RunConfig& config,
                           const WholeRunOptions& options, RunFolder& folder,
                           RunObserver& observer = RunObserver::nobody(),
                           const std::stop_token& stop = {});

}  // namespace sgs::run
