// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "input.h"
#include "sgs/slam/session_config.h"
#include "viewer_link.h"

namespace sgs::app {

/// What `sgs run` was asked to do, as given on the command line.
struct RunRequest {
  InputSpec input;
  std::string output, config_file, preset, tracker, lpips_weights, record, trace;
  std::vector<std::string> assignments;  ///< --set key=value
  std::string seed;                      ///< empty = as configured
  int threads = 2;
  int lpips_stride = 8;
  bool realtime = false, preload = false, no_eval = false, quiet = false, json = false;
  ViewerRequest viewer;
};

/// The configuration a request leads to: preset, then the config file, then --set, then --tracker
/// and --seed. The file may be a run folder's config.toml; its [input] table fills what the command
/// line leaves open.
Result<slam::SessionConfig> resolve_config(RunRequest& request);

/// Text of config.toml: the input and every parameter as used.
std::string effective_config(const InputSpec& input, const slam::SessionConfig& config);

/// Reads a run folder's config.toml back.
struct SavedRun {
  InputSpec input;
  slam::SessionConfig config;
};
Result<SavedRun> load_saved_run(const std::string& folder);

}  // namespace sgs::app
