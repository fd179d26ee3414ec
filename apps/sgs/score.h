// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "finished_run.h"
#include "run_folder.h"
#include "sgs/eval/metrics.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/report/report_data.h"

namespace sgs::app {

/// How to score.
struct ScoreOptions {
  eval::Association association = eval::Association::kInterpolate;
  std::string lpips_weights;  ///< file; empty = LPIPS is not measured
  int lpips_stride = 8;
  int threads = 2;
  bool rendering = true;  ///< false: trajectory scores only (no second pass through the images)
  bool quiet = false;
};

/// Scores of the run on top of `metrics` (which may hold what only the run itself could measure),
/// written with the report and some pictures into `folder`.
Result<eval::Metrics> score_run(const FinishedRun& run, const ScoreOptions& options,
                                eval::Metrics metrics, RunFolder& folder);

/// The report of a run read back from its folder, for drawing only: the trajectory is compared with
/// the truth anew, rendering scores and pictures are those saved in the folder. Writes nothing.
Result<report::ReportData> saved_report(const std::string& folder, eval::Association association);

}  // namespace sgs::app
