// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sgs::suite {

/// The words as one would type them into a shell, quoted where that needs it.
std::string shell_command(std::span<const std::string> words);

/// The command line of this process, the program as it was called.
std::vector<std::string> own_words();

/// How numbers came about, in one line of Markdown: the command line of this process, the
/// program's version, the machine and today's date (UTC).
std::string provenance(std::string_view version);

}  // namespace sgs::suite
