// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/clocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sgs::synthetic {
namespace {

ClockModel kinect_clocks() {
  ClockModel m;
  m.free_running = true;
  m.depth_rate = 0.999;
  m.phase = 0.3;
  return m;
}

TEST(Clocks, DepthFallsBackThroughAWholePeriod) {
  const auto frames = free_running_frames(kinect_clocks(), 1, 61, 30, 1);
  // Once in 33 s an image of colour stays without depth.
  EXPECT_NEAR(static_cast<double>(frames.size()), 1800, 4);
  double least = 1, most = -1, sum = 0, sum2 = 0;
  for (const FrameTimes& f : frames) {
    EXPECT_NEAR(f.stamped_delay_s, f.depth_s - f.color_s, 2e-6);
    EXPECT_NEAR(f.color_s, 1 + static_cast<double>(f.slot) / 30, 1e-9);
    least = std::min(least, f.stamped_delay_s), most = std::max(most, f.stamped_delay_s);
    sum += f.stamped_delay_s, sum2 += f.stamped_delay_s * f.stamped_delay_s;
  }
  const double n = static_cast<double>(frames.size());
  EXPECT_LE(most, 0.02);
  EXPECT_GE(least, -0.02);
  EXPECT_GT(most, 0.012);
  EXPECT_LT(least, -0.012);
  EXPECT_NEAR(std::sqrt(sum2 / n - sum / n * sum / n), 0.0096, 0.002);  // 33 ms / sqrt(12)
}

TEST(Clocks, StampsAreLateAndJitterButKeepTheirOrder) {
  ClockModel m = kinect_clocks();
  m.jitter_s = 0.0015;
  m.stamp_late_s = 0.004;
  const auto frames = free_running_frames(m, 1, 31, 30, 1);
  double late = 0, jitter2 = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    late += frames[i].stamped_delay_s - (frames[i].depth_s - frames[i].color_s);
    jitter2 += std::pow(frames[i].stamp_s - frames[i].color_s, 2);
    if (i == 0) continue;
    EXPECT_GT(frames[i].stamp_s, frames[i - 1].stamp_s);
    EXPECT_GT(frames[i].stamp_s + frames[i].stamped_delay_s,
              frames[i - 1].stamp_s + frames[i - 1].stamped_delay_s);
  }
  const double n = static_cast<double>(frames.size());
  EXPECT_NEAR(late / n, 0.004, 0.0003);
  EXPECT_NEAR(std::sqrt(jitter2 / n), 0.0015, 0.0002);
}

TEST(Clocks, ImagesOfBothCamerasGetLost) {
  ClockModel m = kinect_clocks();
  m.lost = 0.05;
  const auto frames = free_running_frames(m, 1, 101, 30, 1);
  EXPECT_NEAR(static_cast<double>(frames.size()), 3000 * 0.95 * 0.95, 40);
}

TEST(Clocks, SlowRatesFindDepthToo) {
  EXPECT_NEAR(static_cast<double>(free_running_frames(kinect_clocks(), 1, 13, 1, 1).size()), 13, 1);
}

}  // namespace
}  // namespace sgs::synthetic
