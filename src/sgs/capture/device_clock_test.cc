// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/capture/device_clock.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::capture {
namespace {

constexpr double kStep_s = 1.0 / 32, kWrap_s = 4294.967296;

TEST(DeviceClock, StampsGoThroughUnchanged) {
  DeviceClock clock;
  for (int i = 0; i < 100; ++i) {
    const double stamp_s = 1000 + i * kStep_s;
    EXPECT_EQ(clock.continuous(stamp_s, 5 + i * kStep_s), stamp_s);
    EXPECT_EQ(clock.continuous(stamp_s - 0.01, 5.001 + i * kStep_s), stamp_s - 0.01);
  }
  EXPECT_FALSE(clock.take_jump_s());
}

// Images of two streams cross the wrap one after the other.
TEST(DeviceClock, WrapsAreSeamless) {
  DeviceClock clock;
  const double start_s = kWrap_s - 1;
  for (int i = 0; i < 64; ++i) {
    for (const double late_s : {0.0, 0.012}) {
      const double true_s = start_s + i * kStep_s - late_s;
      EXPECT_NEAR(clock.continuous(std::fmod(true_s, kWrap_s), i * kStep_s), true_s, 1e-9);
    }
  }
  EXPECT_FALSE(clock.take_jump_s());
}

TEST(DeviceClock, AClockThatIsSetGoesOn) {
  for (const double jump_s : {3600.0, -500.0}) {
    DeviceClock clock;
    double before_s = 0;
    for (int i = 0; i < 64; ++i) {
      const double stamp_s = 1000 + i * kStep_s + (i >= 32 ? jump_s : 0);
      const double time_s = clock.continuous(stamp_s, i * kStep_s);
      if (i > 0) {
        EXPECT_NEAR(time_s - before_s, kStep_s, 1e-9) << i;
      }
      before_s = time_s;
      // The other stream's image of before the jump comes after it.
      if (i == 32) {
        EXPECT_NEAR(clock.continuous(1000 + 31.5 * kStep_s, 1), 1000 + 31.5 * kStep_s, 1e-9);
      }
    }
    EXPECT_NEAR(clock.take_jump_s().value_or(0), jump_s, 1e-9);
    EXPECT_FALSE(clock.take_jump_s());
  }
}

TEST(DeviceClock, OneWrongStampHarmsNothing) {
  DeviceClock clock;
  for (int i = 0; i < 64; ++i) {
    const double host_s = i * kStep_s;
    if (i % 10 == 5) clock.continuous(1e12 + i, host_s);
    EXPECT_NEAR(clock.continuous(1000 + host_s, host_s), 1000 + host_s, 1e-9) << i;
  }
}

// After a stall of the host what was held up comes at once, and nothing of it is a jump.
TEST(DeviceClock, BurstsAreNoJumps) {
  DeviceClock clock;
  for (int i = 0; i < 200; ++i) {
    const double true_s = i * kStep_s, host_s = i < 100 || i > 160 ? true_s : 160 * kStep_s;
    EXPECT_EQ(clock.continuous(1000 + true_s, host_s), 1000 + true_s);
  }
  EXPECT_FALSE(clock.take_jump_s());
}

TEST(DeviceClock, DriftIsMeasuredByTheFastestArrivals) {
  DeviceClock clock;
  EXPECT_EQ(clock.drift_ppm(), 0);
  for (int i = 0; i < 32 * 120; ++i) {
    const double true_s = i * kStep_s, delay_s = 0.002 + 0.03 * ((i * 37) % 101) / 101;
    clock.continuous(1000 + true_s * (1 - 200e-6), true_s + delay_s);
  }
  EXPECT_NEAR(clock.drift_ppm(), 200, 20);
}

TEST(DeviceClocks, OthersAreBroughtToTheFirst) {
  DeviceClocks clocks;
  for (int i = 0; i < 64; ++i) {
    const double true_s = i * kStep_s;
    EXPECT_EQ(clocks.continuous(0, 1000 + true_s, true_s + 0.005), 1000 + true_s);
    EXPECT_NEAR(clocks.continuous(1, 1.5e9 + true_s, true_s + 0.005), 1000 + true_s, 1e-6);
  }
  EXPECT_TRUE(clocks.take_jumps_s().empty());
  EXPECT_NE(clocks.reference(), nullptr);
}

}  // namespace
}  // namespace sgs::capture
