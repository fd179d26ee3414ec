// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/process_memory.h"

#include <sys/resource.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace sgs::run {

void return_freed_images([[maybe_unused]] bool frames_stay) {
#if defined(__GLIBC__)
  constexpr int kMebibyte = 1 << 20;
  // Images of 640x480 are smaller and used again with the next frame: to give those back as well
  // costs hundreds of page faults for each.
  mallopt(M_MMAP_THRESHOLD, frames_stay ? kMebibyte : 2 * kMebibyte);
  mallopt(M_TRIM_THRESHOLD, 16 * kMebibyte);
  // Frames are made by one thread and freed by others: with an arena for each thread that room is
  // not found again, and nearly half of the memory lies between what is held. Some 10,000
  // allocations a second do not get in each other's way.
  mallopt(M_ARENA_MAX, 1);
#endif
}

std::int64_t peak_rss_bytes() {
  rusage usage{};
  constexpr std::int64_t kKiB = 1024;
  return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss * kKiB : 0;
}

}  // namespace sgs::run
