// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/input/input.h"
#include "sgs/refine/refine_config.h"
#include "sgs/slam/session_config.h"

namespace sgs::run {

/// Every value that decides what a whole run computes.
struct RunConfig {
  slam::SessionConfig session = {};
  refine::RefineConfig refine = {};  ///< of the map at the end, where steps_per_frame is not 0

  void declare(ParameterList& list);
};

/// The values of a preset; an unknown name is an error that lists them.
Result<RunConfig> make_run_config(std::string_view preset);

/// Where the values of a configuration come from, each overriding those before: the preset, a TOML
/// file, single assignments, tracker and seed.
struct ConfigSources {
  std::string preset = "default";
  std::string file;                      ///< TOML, also a run folder's config.toml; empty = none
  std::vector<std::string> assignments;  ///< key=value
  std::string tracker, seed;             ///< empty = as configured
};

/// The configuration that the sources lead to. Where `input` names none, the file's [input] table
/// fills it. Unknown, renamed and unfitting keys are errors that name the remedy.
Result<RunConfig> resolve_config(const ConfigSources& sources, InputSpec& input);

/// Text of config.toml: format and version, the input and every parameter as used.
std::string config_text(const InputSpec& input, const RunConfig& config);

/// What config.toml says.
struct SavedConfig {
  /// Of the run folder. 1: before it held its camera; 2: before it held how a run is refined.
  int format = 1;
  std::string version;  ///< of sgs that made it
  InputSpec input;
  RunConfig config;
};
/// Format of the run folders that this version writes.
inline constexpr int kFolderFormat = 3;
/// Reads a run folder's config.toml. A folder of a later format, and one whose parameters this
/// version no longer knows, are refused by name.
Result<SavedConfig> load_config(const std::filesystem::path& folder);

}  // namespace sgs::run
