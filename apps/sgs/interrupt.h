// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace sgs::app {

/// Turns the first Ctrl-C (SIGINT) or SIGTERM into a request to stop; a second one ends the program
/// at once.
void install_interrupt_handler();
/// True once the user asked to stop.
bool interrupted();

}  // namespace sgs::app
