// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "run_request.h"

#include <filesystem>

#include "sgs/io/toml_config.h"

namespace sgs::app {

Result<slam::SessionConfig> resolve_config(RunRequest& request) {
  SGS_ASSIGN_OR_RETURN(auto config, slam::make_session_config(request.preset));
  if (!request.config_file.empty()) {
    InputSpec from_file;
    ParameterList list;
    from_file.declare(list);
    config.declare(list);
    SGS_RETURN_IF_ERROR(io::apply_toml_file(request.config_file, list));
    if (request.input.input.empty()) request.input = from_file;
  }
  ParameterList list;
  config.declare(list);
  for (const std::string& assignment : request.assignments) {
    SGS_RETURN_IF_ERROR(list.set_assignment(assignment));
  }
  if (!request.tracker.empty()) SGS_RETURN_IF_ERROR(list.set("tracker.type", request.tracker));
  if (!request.seed.empty()) SGS_RETURN_IF_ERROR(list.set("slam.seed", request.seed));
  // The input's words go to config.toml, too.
  SGS_RETURN_IF_ERROR(check(request.input));
  return config;
}

std::string effective_config(const InputSpec& input, const slam::SessionConfig& config) {
  // Declaring needs mutable fields; copies keep the arguments const.
  InputSpec input_copy = input;
  slam::SessionConfig config_copy = config;
  // Folders are remembered absolutely: `sgs eval` may be called from anywhere.
  std::error_code error;
  for (std::string* path : {&input_copy.input, &input_copy.trajectory}) {
    if (!path->empty() && std::filesystem::exists(*path, error)) {
      *path = std::filesystem::absolute(*path, error).lexically_normal().string();
    }
  }
  ParameterList list;
  input_copy.declare(list);
  config_copy.declare(list);
  return "# Written by sgs. Every value as used; `sgs run --config` accepts this file.\n" +
         list.to_toml();
}

Result<SavedRun> load_saved_run(const std::string& folder) {
  SavedRun run;
  ParameterList list;
  run.input.declare(list);
  run.config.declare(list);
  const auto path = std::filesystem::path(folder) / "config.toml";
  if (auto status = io::apply_toml_file(path, list); !status) {
    Error error = status.error();
    error.remedy += error.remedy.empty() ? "" : "; ";
    error.remedy += fmt::format("is '{}' a run folder made by this version of sgs?", folder);
    return tl::unexpected(error);
  }
  return run;
}

}  // namespace sgs::app
