// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs::app {

/// Opens /dev/null where standard input, output or error is closed. Otherwise the next file that is
/// opened takes its number, and what is printed goes into it. To be called before anything else.
void open_standard_streams();

}  // namespace sgs::app
