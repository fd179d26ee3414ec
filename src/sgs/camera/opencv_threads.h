// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs {

/// Keeps OpenCV to the thread that calls it: results and the use of cores are the program's own
/// affair. To be called before any of OpenCV's functions that would share work out. Only the first
/// call does anything: OpenCV takes its threads down for a change of their number, even to the same
/// one, and a remap() that runs in another thread at that moment crashes. Thread-safe.
void keep_opencv_to_one_thread();

}  // namespace sgs
