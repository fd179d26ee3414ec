// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "input.h"
#include "run_folder.h"
#include "sgs/eval/metrics.h"
#include "sgs/eval/run_evaluator.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/map/gaussian.h"
#include "sgs/slam/session_config.h"

namespace sgs::app {

/// What a finished run left behind: all that scoring and reporting need.
struct FinishedRun {
  InputSpec input;
  slam::SessionConfig config;
  Trajectory trajectory;  ///< estimated, one pose per readable frame
  Trajectory keyframes;   ///< of the mapper, refined
  Trajectory truth;       ///< empty where there is none
  std::vector<map::Gaussian> gaussians;
  std::string frames_csv;
  std::string timings_json;  ///< "" where it is not known
  std::string config_toml;   ///< as saved with the run
  std::string name;          ///< of the sequence
  std::int64_t frames = 0;   ///< frames of the sequence, bad and dropped ones included
};

/// A run read back from its folder, with the scores saved there (empty ones where there are none).
struct LoadedRun {
  FinishedRun run;
  eval::Metrics metrics;
};
Result<LoadedRun> load_finished_run(const std::string& folder);

/// The pictures kept for the report, in and out of the folder's renders/.
void save_pictures(const std::vector<eval::FramePictures>& pictures, RunFolder& folder);
/// Empty where the folder has none.
std::vector<eval::FramePictures> load_pictures(const std::filesystem::path& folder);

}  // namespace sgs::app
