// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sgs::run {

/// Version of this library and of the program, "major.minor.patch".
std::string version();

}  // namespace sgs::run
