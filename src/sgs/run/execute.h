// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "sgs/run/play.h"
#include "sgs/run/run_observer.h"
#include "sgs/runfolder/resume.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

/// What a run is asked for beside its input and its configuration.
struct RunOptions {
  int threads = 2;
  bool realtime = false;     ///< at the sensor's rate, late frames dropped
  bool preload = false;      ///< all frames are decoded before the clock starts
  std::string record;        ///< folder that keeps the input (TUM layout); empty = none
  std::string trace;         ///< file for a time line of all threads; empty = none
  double checkpoint_s = 10;  ///< the map is kept at least this often while it grows; 0 = never
  std::optional<ResumePoint> resume;  ///< in a folder of RunFolder::resume(); empty = a new run
  std::stop_token enough = {};  ///< the frames end here, as if there were no more: a proper end
};

/// What came of a run that could start.
struct RunResult {
  Run run;
  Status input;                          ///< why it ended early, other than by request
  bool stopped = false;                  ///< by request, before its proper end
  std::filesystem::path recording = {};  ///< newest folder that the input was kept in; or empty
  bool lost = false;                     ///< at the end, or for more than half of the frames
  std::string not_found =
      {};                    ///< how near it came to a place in its map, where it never was; or ""
  std::string too_few = {};  ///< why hardly any frame could be used; else empty
};

/// SLAM on an open input: tracks, maps, and writes everything but scores into `folder`: frames and
/// poses within a second (Journal), the map now and then (MapCheckpoints), all of it anew at the
/// end, when state.toml says so. Fails only where nothing could be computed; what could not be
/// written is in folder.failures(). With options.resume an earlier run goes on; where that cannot
/// be, its folder stays as it was.
Result<RunResult> execute(Input& input, const InputSpec& spec, const RunConfig& config,
                          const RunOptions& options, RunFolder& folder,
                          RunObserver& observer = RunObserver::nobody(),
                          const std::stop_token& stop = {});

}  // namespace sgs::run
