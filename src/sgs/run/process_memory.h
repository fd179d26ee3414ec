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

/// Gives room that is free between what is held back to the system, at most every five minutes:
/// after an hour it is a quarter of a process's memory. It takes 30 to 50 ms, in which nobody can
/// allocate.
class FreeRoom {
 public:
  /// `now_s`: of a clock that never goes back. True where it was time. Nothing is given back in the
  /// first minutes, when all of it is used again.
  bool maybe_return(double now_s);

 private:
  double next_s_ = 0;  // 0: not asked yet
};

/// Largest resident set of this process so far, bytes; 0 when the system does not tell.
std::int64_t peak_rss_bytes();

}  // namespace sgs::run
