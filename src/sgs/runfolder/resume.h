// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sgs/runfolder/run_config.h"

namespace sgs::run {

/// Where a run can be gone on from.
struct ResumePoint {
  SavedConfig saved;        ///< input and configuration
  std::string config_toml;  ///< the same as its folder has it
  /// The resume.sgs of its last checkpoint; empty: there is none, it begins with the first frame.
  std::filesystem::path checkpoint;
};

/// Of a folder whose run was killed or interrupted. A run that is finished, that was live or that
/// another version made is an error that says so.
Result<ResumePoint> load_resume_point(const std::filesystem::path& folder);

}  // namespace sgs::run
