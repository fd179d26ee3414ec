// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "sgs/core/error.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// The frames of a folder by the layout that it has the marks of. The folder must have one
/// (locate_recording()).
Result<FrameList> list_frames(const std::filesystem::path& folder, const OpenOptions& options);

/// The refusal of a folder in which something is still packed as a whole, with the commands that
/// unpack it; empty where nothing is.
std::optional<Error> packed_in(const std::filesystem::path& folder);

}  // namespace sgs::dataset
