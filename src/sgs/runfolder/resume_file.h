// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sgs/core/error.h"

namespace sgs::run {

/// Format of the states that this version writes. To be raised whenever what slam::Session saves,
/// or what it does with it, changes: a state is gone on from by the same format only.
inline constexpr int kResumeFormat = 7;

/// Writes what slam::Session::save() gave, with a length and a checksum.
Status save_resume_file(const std::filesystem::path& path, std::string state);

/// Reads it back whole or not at all: a file that is cut off, damaged, of another format, of
/// another version of the program or of a processor whose kernels give other bits is refused by
/// name.
Result<std::string> load_resume_file(const std::filesystem::path& path);

}  // namespace sgs::run
