// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/low_priority.h"

#ifdef __linux__
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace sgs {

void lower_thread_priority([[maybe_unused]] int nice) {
#ifdef __linux__
  // Linux schedules threads, not processes: a thread's id is accepted where POSIX says process.
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  const int base = getpriority(PRIO_PROCESS, thread);
  setpriority(PRIO_PROCESS, thread, base + nice > 19 ? 19 : base + nice);
#endif
}

}  // namespace sgs
