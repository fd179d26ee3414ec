// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/core/memory_reserve.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <list>
#include <new>
#include <string>

namespace sgs {
namespace {

int times_told = 0;

/// Takes memory until there is none; returns how much it got, in blocks.
std::size_t fill_memory(std::list<std::string>& blocks) {
  constexpr std::size_t kBlock_bytes = 1 << 20;
  try {
    while (true) blocks.emplace_back(kBlock_bytes, 'x');
  } catch (const std::bad_alloc&) {
    return blocks.size();
  }
}

/// In a process of its own, whose address space ends.
void run_short() {
  keep_memory_reserve([] { ++times_told; });
  const bool before = memory_ran_short();
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = rlim_t{512} << 20;
  setrlimit(RLIMIT_AS, &limit);
  std::list<std::string> blocks;
  const std::size_t all = fill_memory(blocks);
  const bool told_once = times_told == 1 && memory_ran_short() && !before;
  blocks.clear();
  std::exit(told_once && all > 16 ? 0 : 1);
}

TEST(MemoryReserve, IsThereWhenTheMemoryEndsAndToldOfOnce) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take more address space than there is here";
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(run_short(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace sgs
