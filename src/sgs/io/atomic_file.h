// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sgs/core/error.h"

namespace sgs::io {

/// The whole content of a file. Folders, missing and unreadable files are errors that name it.
Result<std::string> read_file(const std::filesystem::path& path);

/// Replaces `path` by `bytes` in one step: they are written to a temporary file beside it, which is
/// then renamed, so that a reader never sees half a file and a failed write leaves the old one.
/// (No fsync: protects against crashes of the program, not of the machine.) Devices and pipes are
/// written to directly. Missing parent folders are created. Every failure, a full disk included, is
/// an error that names the file and the system's reason.
Status write_file(const std::filesystem::path& path, std::string_view bytes);

/// Appends `bytes` to a file, creating it (and its parent folders) where it is missing.
Status append_file(const std::filesystem::path& path, std::string_view bytes);

/// Creates a folder and its parents; an existing folder is fine.
Status make_folder(const std::filesystem::path& path);

}  // namespace sgs::io
