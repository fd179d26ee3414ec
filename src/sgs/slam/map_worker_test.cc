// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/map_worker.h"

#include <gtest/gtest.h>

#include <thread>

namespace sgs::slam {
namespace {

bool leaves_core(WorkerMode mode, int threads) {
  const auto config = make_session_config("default");
  EXPECT_TRUE(config);
  MapWorker worker(*config, {64, 48, 50, 50, 31.5, 23.5}, false, mode, threads);
  return worker.leave_core() != nullptr;
}

TEST(MapWorker, LeavesACoreWhereItsThreadsFillThemAll) {
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  EXPECT_TRUE(leaves_core(WorkerMode::kThread, cores));
  EXPECT_TRUE(leaves_core(WorkerMode::kLive, cores + 1));
  if (cores > 2) {
    EXPECT_FALSE(leaves_core(WorkerMode::kLive, 2));
  }
}

// Inline the thread that asks is the one that maps.
TEST(MapWorker, HasNoCoreToLeaveWhenItWorksInline) {
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  EXPECT_FALSE(leaves_core(WorkerMode::kInline, cores + 1));
}

}  // namespace
}  // namespace sgs::slam
