// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::mapjoin {

/// What became of joining map files.
struct JoinedFiles {
  std::vector<std::string> joined;  ///< how each map was joined, in that order
  std::vector<std::string>
      not_joined;  ///< why others were not; if there are any nothing is written
};

/// Joins the maps `inputs` (files or run folders) in the world of the first one into the file
/// `output`, which is replaced in one step. A map that is not found in what is joined so far is
/// looked for again after the others. Inputs are only read: an output that is one of them, and maps
/// that have a session in common, are refused.
Result<JoinedFiles> join_files(const std::vector<std::filesystem::path>& inputs,
                               const std::filesystem::path& output, int threads);

}  // namespace sgs::mapjoin
