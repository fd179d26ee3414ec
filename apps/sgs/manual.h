// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands.h"

namespace sgs::app {

/// `sgs man` and `sgs completion`. They are made from all the other commands: to be added last.
void add_manual(CLI::App& app, Action& action);

}  // namespace sgs::app
