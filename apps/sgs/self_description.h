// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace sgs::app {

/// The manual of the program (`command` null) or of one of its commands, in the language of man
/// (roff), made from what the options say of themselves.
std::string man_page(const CLI::App& program, const CLI::App* command);

/// A script that completes command lines in bash: commands, options, words that an option allows;
/// `keys` are what --set takes.
std::string bash_completion(const CLI::App& program, const std::vector<std::string>& keys);

/// The commands of the program.
std::vector<const CLI::App*> commands_of(const CLI::App& program);

}  // namespace sgs::app
