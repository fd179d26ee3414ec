// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::render {

/// Names of the instruction sets that this build has kernels for and this machine can run, best
/// first (e.g. avx512, avx2, sse4).
std::vector<std::string> instruction_sets();

/// Makes every dispatched kernel of the process use `name`, one of instruction_sets(); "best" goes
/// back to the default. For measurements and for bits that agree with those of another machine:
/// call it before any other thread runs kernels.
Status use_instruction_set(const std::string& name);

}  // namespace sgs::render
