// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "sgs/core/error.h"

namespace sgs::io {

// limit: any other file that is read whole, bytes
inline constexpr std::int64_t kLargestFile_bytes = std::int64_t{4} << 30;  ///< of read_file()

/// The whole content of a regular file of at most `limit_bytes`. Folders, pipes, devices, files
/// beyond the limit, missing and unreadable files are errors that name it: a pipe nobody writes to
/// would block for ever, a device never end.
Result<std::string> read_file(const std::filesystem::path& path,
                              std::int64_t limit_bytes = kLargestFile_bytes);

/// Whether what was written is on the disk, and not only with the system, when a write returns.
enum class Durability {
  kRelaxed,  ///< survives the program
  kSynced,   ///< survives a power cut, too
};

/// Replaces `path` by `bytes` in one step: they are written to a temporary file beside it, which is
/// then renamed, so that a reader never sees half a file and a failed write leaves the old one.
/// Devices and pipes are written to directly. Missing parent folders are created. Every failure, a
/// full disk included, is an error that names the file and the system's reason.
Status write_file(const std::filesystem::path& path, std::string_view bytes,
                  Durability durability = Durability::kSynced);

/// The next piece of a file, good until the next call; empty at the end.
using NextBlock = std::function<std::string_view()>;

/// The same of a file that need not be in memory as a whole.
Status write_file_in_blocks(const std::filesystem::path& path, const NextBlock& next,
                            Durability durability = Durability::kSynced);

/// Whether `name` is that of a temporary file of write_file() for a file called `file`: a program
/// that is killed while it writes leaves one behind.
bool is_temporary_of(std::string_view name, std::string_view file);

/// Appends `bytes` to a file, creating it (and its parent folders) where it is missing.
Status append_file(const std::filesystem::path& path, std::string_view bytes);

/// Creates a folder and its parents; an existing folder is fine.
Status make_folder(const std::filesystem::path& path);

}  // namespace sgs::io
