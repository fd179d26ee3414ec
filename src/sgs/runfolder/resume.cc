// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/resume.h"

#include <fmt/format.h>

#include "sgs/io/atomic_file.h"
#include "sgs/runfolder/checkpoint_folders.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/runfolder/run_state.h"
#include "sgs/runfolder/version.h"

namespace sgs::run {
namespace fs = std::filesystem;
namespace {

Status check_state(const fs::path& folder) {
  std::error_code unreadable;
  if (!fs::exists(folder / files::kState, unreadable)) {
    return fail(ErrorCode::kNotFound, fmt::format("{} is no run folder", folder.string()),
                "give a folder made by `sgs run`");
  }
  SGS_ASSIGN_OR_RETURN(const auto state, load_state(folder));
  if (state.stage == Stage::kFinished) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the run in {} is finished: there is nothing to go on with", folder.string()),
        "see it with `sgs view` or `sgs eval`");
  }
  if (state.live) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("the run in {} was live: what it did depended on the time", folder.string()),
        "what it had done can be read as it is; run it again from the beginning");
  }
  return {};
}

}  // namespace

Result<ResumePoint> load_resume_point(const fs::path& folder) {
  SGS_RETURN_IF_ERROR(check_state(folder));
  ResumePoint point;
  if (const auto text = io::read_file(folder / files::kConfig)) {
    point.config_toml = *text;
  } else {
    return fail(
        ErrorCode::kNotFound,
        fmt::format("the run in {} had not begun: it has no {}", folder.string(), files::kConfig),
        "run it again");
  }
  SGS_ASSIGN_OR_RETURN(point.saved, load_config(folder));
  if (point.saved.version != version()) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} was made by sgs {}, not by this one ({})", folder.string(),
                            point.saved.version, version()),
                "go on with that version, or run it again from the beginning");
  }
  const fs::path checkpoint = newest_checkpoint(folder) / files::kResume;
  std::error_code unreadable;
  if (fs::exists(checkpoint, unreadable)) point.checkpoint = checkpoint;
  return point;
}

}  // namespace sgs::run
