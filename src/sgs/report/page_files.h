// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sgs::report {

/// A script or style sheet of the folder page/, by its file name.
std::string_view page_text(std::string_view name);

}  // namespace sgs::report
