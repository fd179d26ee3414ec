// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "sgs/core/error.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// Whether a file is to be read as ScanNet's .sens.
bool is_sens(const std::filesystem::path& file);

/// Opens a ScanNet recording: colour and depth registered, delivered on the depth's grid; the
/// recording's poses are the ground truth. A file that is cut off gives the frames that are whole,
/// with a warning. The sequence is not prefetched.
Result<Sequence> open_sens(const std::filesystem::path& file, const OpenOptions& options);

}  // namespace sgs::dataset
