// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "sgs/core/error.h"

namespace sgs::io {

/// How a packed file is unpacked.
struct Unpacking {
  std::string command;             ///< for a shell
  std::filesystem::path unpacked;  ///< the file or folder that it leaves
};

/// What a file's name says about how it is packed (.zip, .tgz, .zst, ... in either case); empty for
/// a file that is not packed as a whole.
std::optional<Unpacking> unpacking_of(const std::filesystem::path& file);

/// The error of a packed file, with the command that unpacks it as its remedy.
tl::unexpected<Error> packed_as_a_whole(const std::filesystem::path& file,
                                        const Unpacking& unpacking);

/// A path as a shell takes it: in quotes where it needs them.
std::string shell_quoted(const std::filesystem::path& path);

}  // namespace sgs::io
