// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/slam/frame_record.h"

namespace sgs::run {

/// What moved in the frames of a run (FrameRecord::movers), one line for each frame in which
/// something did: its index, and the squares in hexadecimal. Empty where nothing moved.
std::string movers_text(const std::vector<slam::FrameRecord>& frames);
/// Puts it back into the records; lines of frames that there are none of are left out. A line that
/// cannot be read is an error that names the file and the line.
Status load_movers(const std::filesystem::path& path, std::vector<slam::FrameRecord>& frames);

}  // namespace sgs::run
