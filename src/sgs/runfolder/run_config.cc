// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/run_config.h"

#include <fmt/format.h>

#include "sgs/io/toml_config.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/runfolder/version.h"
#include "sgs/tracker/tracker_kind.h"

namespace sgs::run {
namespace {

/// The [run] table of config.toml.
struct Stamp {
  int format = 1;
  std::string version;

  void declare(ParameterList& list) {
    constexpr double kAny = 1e6;
    const auto group = list.group("run");
    list.add("format", format, "Format of the run folder.", "", {1, kAny});
    list.add("version", version, "Version of sgs that made it.", {});
  }
};

/// Before folders said so, it was the name of the preset that had a run refined.
constexpr int kFormatWithRefinement = 3;
constexpr double kQualityStepsPerFrame = 15;

/// Fills in what the file of an earlier version did not say.
void complete(const Stamp& stamp, RunConfig& config) {
  const bool of_a_run = !stamp.version.empty();
  if (!of_a_run || stamp.format >= kFormatWithRefinement) return;
  if (config.session.preset == slam::Preset::kQuality) {
    config.refine.steps_per_frame = kQualityStepsPerFrame;
  }
}

}  // namespace

void RunConfig::declare(ParameterList& list) {
  session.declare(list);
  list.add_group("refine", refine);
}

Result<RunConfig> make_run_config(std::string_view preset) {
  RunConfig config;
  SGS_ASSIGN_OR_RETURN(config.session, slam::make_session_config(preset));
  if (config.session.preset == slam::Preset::kQuality) {
    config.refine.steps_per_frame = kQualityStepsPerFrame;
  }
  return config;
}

Result<RunConfig> resolve_config(const ConfigSources& sources, InputSpec& input) {
  SGS_ASSIGN_OR_RETURN(auto config, make_run_config(sources.preset));
  if (!sources.file.empty()) {
    Stamp stamp;
    InputSpec from_file;
    ParameterList list;
    stamp.declare(list);
    from_file.declare(list);
    config.declare(list);
    SGS_RETURN_IF_ERROR(io::apply_toml_file(sources.file, list));
    complete(stamp, config);
    if (input.input.empty()) input = from_file;
  }
  ParameterList list;
  config.declare(list);
  for (const std::string& assignment : sources.assignments) {
    SGS_RETURN_IF_ERROR(list.set_assignment(assignment));
  }
  if (!sources.tracker.empty()) SGS_RETURN_IF_ERROR(list.set("tracker.type", sources.tracker));
  if (!sources.seed.empty()) SGS_RETURN_IF_ERROR(list.set("slam.seed", sources.seed));
  const bool given = tracker::takes_given_poses(config.session.tracker);
  if (given && input.poses.empty()) input.poses = dataset::kRecordedPoses;
  if (!given && input.poses == dataset::kRecordedPoses) input.poses.clear();
  if (!given && !input.poses.empty()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("poses are given, but the tracker {} finds its own",
                            to_string(config.session.tracker.type)),
                "--poses goes with --tracker given");
  }
  // The input's words go to config.toml, too.
  SGS_RETURN_IF_ERROR(check(input));
  return config;
}

std::string config_text(const InputSpec& input, const RunConfig& config) {
  // Declaring needs mutable fields; copies keep the arguments const.
  Stamp stamp{kFolderFormat, version()};
  InputSpec input_copy = input;
  RunConfig config_copy = config;
  // Folders are remembered absolutely: a run may be evaluated from anywhere.
  std::error_code error;
  for (std::string* path : {&input_copy.input, &input_copy.trajectory, &input_copy.calibration,
                            &input_copy.poses, &input_copy.camera, &input_copy.map}) {
    if (!path->empty() && std::filesystem::exists(*path, error)) {
      *path = std::filesystem::absolute(*path, error).lexically_normal().string();
    }
  }
  input_copy.more_files.clear();
  for (const auto& file : more_files_of(input)) {
    if (!input_copy.more_files.empty()) input_copy.more_files += '\n';
    input_copy.more_files += std::filesystem::absolute(file, error).lexically_normal().string();
  }
  ParameterList list;
  stamp.declare(list);
  input_copy.declare(list);
  config_copy.declare(list);
  return "# Written by sgs. Every value as used; `sgs run --config` accepts this file.\n" +
         list.to_toml();
}

Result<SavedConfig> load_config(const std::filesystem::path& folder) {
  Stamp stamp;
  SavedConfig saved;
  ParameterList list;
  stamp.declare(list);
  saved.input.declare(list);
  saved.config.declare(list);
  list.read_earlier_versions();
  const auto status = io::apply_toml_file(folder / files::kConfig, list);
  const bool later = stamp.format > kFolderFormat;
  if (!status || later) {
    Error error = status ? Error{ErrorCode::kUnsupported, "", ""} : status.error();
    if (later) {
      error.code = ErrorCode::kUnsupported;
      error.message = fmt::format("{} was made by sgs {}, a later version than this ({})",
                                  folder.string(), stamp.version, version());
      error.remedy = "use that version, or run the sequence again";
    } else {
      error.remedy += error.remedy.empty() ? "" : "; ";
      error.remedy += fmt::format("is '{}' a run folder made by this version of sgs ({})?",
                                  folder.string(), version());
    }
    return tl::unexpected(error);
  }
  complete(stamp, saved.config);
  saved.format = stamp.format;
  saved.version = stamp.version;
  // The folder's own copy: the file it was made with may have moved or changed.
  const auto calibration = folder / files::kCalibration;
  std::error_code ignored;
  if (!saved.input.calibration.empty() && std::filesystem::exists(calibration, ignored)) {
    saved.input.calibration = calibration.string();
  }
  return saved;
}

}  // namespace sgs::run
