// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/run/input.h"
#include "sgs/slam/session_config.h"

namespace sgs::run {

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
Result<slam::SessionConfig> resolve_config(const ConfigSources& sources, InputSpec& input);

/// Text of config.toml: format and version, the input and every parameter as used.
std::string config_text(const InputSpec& input, const slam::SessionConfig& config);

/// What config.toml says.
struct SavedConfig {
  int format = 1;       ///< of the run folder; 1: before it held its camera
  std::string version;  ///< of sgs that made it
  InputSpec input;
  slam::SessionConfig config;
};
/// Format of the run folders that this version writes.
inline constexpr int kFolderFormat = 2;
/// Reads a run folder's config.toml. A folder of a later format, and one whose parameters this
/// version no longer knows, are refused by name.
Result<SavedConfig> load_config(const std::filesystem::path& folder);

}  // namespace sgs::run
