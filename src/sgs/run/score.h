// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "sgs/eval/metrics.h"
#include "sgs/eval/run_evaluator.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/run/run_observer.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

/// How to score.
struct ScoreOptions {
  int novel_views = 24;  ///< of a synthetic input, off the path; 0 = none
  eval::Association association = eval::Association::kInterpolate;
  eval::RunEvaluatorConfig rendering;  ///< heldout_interval is the run's, whatever stands here
  std::string lpips_weights;           ///< file; empty = LPIPS is not measured
  int threads = 2;
};

/// A run judged.
struct Scores {
  eval::TrajectoryMetrics trajectory;
  std::optional<eval::RunEvaluation> rendering;  ///< empty: pictures were not compared
  eval::Metrics metrics;                         ///< the run's own, with these scores in them
  /// Why no picture could be compared, one line: the recording could not be opened. Scores of
  /// pictures that the run had are in `metrics` still, marked as kept. Else empty.
  std::string no_recording;
};

/// Compares the trajectory with the truth and counts the frames' states; needs no recording.
/// Rendering scores that the run already has stay.
Scores score_trajectory(const Run& run, eval::Association association);

/// Also renders the map at every pose and compares with the recording, which is opened anew; where
/// that cannot be, Scores::no_recording says why, and the path is scored all the same. A stop
/// request ends it early: the scores of the pictures are then left out of the metrics, as they
/// would be those of a part.
Result<Scores> score_run(const Run& run, const ScoreOptions& options,
                         RunObserver& observer = RunObserver::nobody(),
                         const std::stop_token& stop = {});

/// Says in words when directions were unobservable and nothing filled them; else "".
std::string degeneracy_note(const eval::Metrics& metrics);

}  // namespace sgs::run
