// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "input.h"
#include "run_folder.h"
#include "sgs/eval/metrics.h"
#include "sgs/eval/report.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/map/gaussian.h"
#include "sgs/slam/session_config.h"

namespace sgs::app {

/// What a finished run left behind: all that scoring and reporting need.
struct FinishedRun {
  InputSpec input;
  slam::SessionConfig config;
  Trajectory trajectory;  ///< estimated, one pose per readable frame
  Trajectory truth;       ///< empty where there is none
  std::vector<map::Gaussian> gaussians;
  std::string frames_csv;
  std::string config_toml;  ///< as saved with the run
  std::string name;         ///< of the sequence
  std::int64_t frames = 0;  ///< frames of the sequence, bad and dropped ones included
};

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

}  // namespace sgs::app
