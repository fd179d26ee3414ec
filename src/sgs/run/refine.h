// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "sgs/refine/refiner.h"
#include "sgs/run/run_observer.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

/// How a run is to be learnt on.
struct RefineOptions {
  refine::RefineConfig config;
  refine::Budget budget;
  int threads = 2;
  /// Seconds between two writings of the best state so far; 0 = only at the end.
  double keep_every_s = 30;
};

/// As many steps as `refine.steps_per_frame` and `refine.least_steps` ask for in a run.
refine::Budget budget_by_frames(const refine::RefineConfig& config, const Run& run);

/// A map and poses from elsewhere as a run: the recording's frames at the poses in `poses`, which
/// lie in the world of `map`, interpolated where frames lie between two of them.
/// `heldout_interval` as in slam::SessionConfig. An error where no frame has a pose.
Result<Run> run_of_map(const InputSpec& input, map::SplatMap map, Trajectory poses,
                       const RunConfig& config, int threads);

struct RefinedRun {
  Run run;  ///< the run with its map and poses as refined; scores are those of before
  refine::Refined refined;  ///< how it went; its Gaussians are in `run`
  std::int64_t frames_used = 0, frames_heldout = 0;
};

/// Learns the map of a run on, from all its frames that are tracked and not held out, with
/// options.config. The best state by the held-out frames, the beginning included, is written
/// into `folder`: from time to time while it goes on, and at the end. An error names the first
/// frame of the recording that is not the one of the run; nothing is written then. A stop request
/// ends it with the best state so far.
Result<RefinedRun> refine_run(const Run& run, const RefineOptions& options, RunFolder& folder,
                              RunObserver& observer = RunObserver::nobody(),
                              const std::stop_token& stop = {});

/// What the run's own `config.toml` does not say: every parameter as used, into `folder`.
void save_refine_parameters(const std::string& source, const RefineOptions& options,
                            RunFolder& folder);

/// A folder beside the run or map at `source` that is free: NAME-refined, NAME-refined-2, ...
std::filesystem::path refined_folder_of(const std::filesystem::path& source);

}  // namespace sgs::run
