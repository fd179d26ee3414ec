// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace sgs::run {

/// Makes the C library give arrays of images size back to the system as soon as they are freed, and
/// all threads share one heap. Otherwise those of keyframes, which live long, end up scattered
/// between those of frames, which do not, and long runs take twice the memory. Where `frames_stay`
/// in memory (--preload), so would theirs; otherwise images of up to 2 MB are used again. Call it
/// before any thread starts.
void return_freed_images(bool frames_stay = false);

/// Largest resident set of this process so far, bytes; 0 when the system does not tell.
std::int64_t peak_rss_bytes();

}  // namespace sgs::run
