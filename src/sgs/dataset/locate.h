// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/core/error.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// The frames of a folder by the layout that it has the marks of. The folder must have one
/// (locate_recording()).
Result<FrameList> list_frames(const std::filesystem::path& folder, const OpenOptions& options);

}  // namespace sgs::dataset
