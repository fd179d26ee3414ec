// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sgs::app {

/// Prints what `sgs info MAP` says of a map file; returns the exit code.
int print_map(const std::string& path, bool json);

}  // namespace sgs::app
