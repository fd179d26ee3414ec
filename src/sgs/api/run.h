// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "sgs/api/config.h"
#include "sgs/api/evaluate.h"
#include "sgs/api/export.h"
#include "sgs/api/stop.h"
#include "sgs/api/types.h"

namespace sgs::api {

/// What a run is asked for beside its input and configuration, as for `sgs run`.
struct RunOptions {
  std::string output;         ///< run folder; empty = runs/TIME-NAME
  int threads = 2;            ///< 1 .. 256
  bool realtime = false;      ///< at the sensor's rate, late frames dropped
  bool pictures = true;       ///< score the map's pictures, which takes a second pass
  std::string lpips_weights;  ///< file; empty = LPIPS is not measured
  std::string record;         ///< folder that keeps the input (TUM layout); empty = none
};

/// What came of a run.
struct RunSummary {
  std::string folder;
  std::int64_t frames = 0;  ///< bad ones included
  bool stopped = false;     ///< by request; the folder is complete for the frames done
  bool lost = false;        ///< tracking was lost at the end or for more than half of the frames
  Metrics metrics;          ///< as metrics.json has them
};

/// `sgs run`: SLAM on a whole input, its map refined where the configuration says so (preset
/// "quality"), scored, with a report, kept in a folder. `input` and `input_options` as for
/// Recording::open(); the option "calibration" may also be "auto": the input is calibrated from
/// itself first. `progress`, where given, is told the frames done, on the calling thread. Throws
/// what opening throws, kInvalidArgument where frames that come only once would be needed twice,
/// and kIo where something could not be written.
SGS_API RunSummary run(const std::string& input, const Settings& input_options = {},
                       const Config& config = Config(), const RunOptions& options = RunOptions(),
                       const std::function<void(std::int64_t frames)>& progress = {},
                       const Stop& stop = Stop());

}  // namespace sgs::api
