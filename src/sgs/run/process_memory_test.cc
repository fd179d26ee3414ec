// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/process_memory.h"

#include <gtest/gtest.h>

namespace sgs::run {
namespace {

TEST(FreeRoom, IsReturnedEveryFiveMinutes) {
  FreeRoom room;
  EXPECT_FALSE(room.maybe_return(1000));  // the clock may begin anywhere
  EXPECT_FALSE(room.maybe_return(1299));
  EXPECT_TRUE(room.maybe_return(1301));
  EXPECT_FALSE(room.maybe_return(1302));
  EXPECT_TRUE(room.maybe_return(1601));
}

TEST(ProcessMemory, PeakIsAtLeastWhatIsHeld) { EXPECT_GT(peak_rss_bytes(), 1 << 20); }

}  // namespace
}  // namespace sgs::run
