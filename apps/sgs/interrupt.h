// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

namespace sgs::app {

/// Turns the first Ctrl-C (SIGINT), SIGTERM or hang-up into a request to stop, and so a lack of
/// memory (core/memory_reserve.h); the next signal ends the program at once. Call it before any
/// thread starts.
void install_interrupt_handler();
/// What the library is given to ask whether the user wants to stop.
std::stop_token stop_token();
/// True once somebody asked to stop.
bool interrupted();

}  // namespace sgs::app
