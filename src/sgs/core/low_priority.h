// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs {

/// Gives the calling thread a lower scheduling priority than the rest of the program (`nice` 1..19
/// as of nice(1)), where the system can do that for a single thread (Linux); otherwise nothing.
void lower_thread_priority(int nice);

}  // namespace sgs
