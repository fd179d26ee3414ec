// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "sgs/runfolder/run.h"
#include "sgs/viewer/server.h"

namespace sgs::app {

/// Refines `run`, which lies in `folder`, for three minutes as `sgs refine` does, while pages show
/// the map as it gets better: `last` once more with each, numbered on from `map_version`. Asked for
/// once more there, or interrupted, it ends with the best so far. Gives the folder of the result;
/// what it came to, and why it failed, is told to the pages.
Result<std::filesystem::path> refine_shown(const run::Run& run, const std::filesystem::path& folder,
                                           const viewer::FrameUpdate& last,
                                           std::uint64_t& map_version, viewer::Server& server);

}  // namespace sgs::app
