// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/map_worker.h"

#include <gtest/gtest.h>

#include <thread>

#include "sgs/mapper/test_wall_scene.h"

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

// What a last change of depth has moved is learnt again also where steps are made as time allows:
// nobody waits for them any more then.
TEST(MapWorker, AKeyframesTurnAfterTheLastFrameIsTakenLive) {
  constexpr int kTurns = 3, kSteps = 40;
  auto config = make_session_config("default");
  ASSERT_TRUE(config);
  config->mapper.iterations_per_frame = kSteps;
  const auto frame = mapper::wall_frame(mapper::small_camera(), SE3{});
  history::Revision revision;
  revision.path.append({frame->index, frame->timestamp_s, SE3{}});
  for (const bool is_turn : {false, true}) {
    MapWorker worker(*config, frame->camera, false, WorkerMode::kLive, 1);
    worker.submit({frame, revision});
    for (int k = 0; k < kTurns; ++k) worker.submit({nullptr, revision, 1, is_turn});
    worker.finish();
    if (is_turn) {
      EXPECT_GE(worker.iterations(), kTurns * kSteps);
    } else {
      EXPECT_LT(worker.iterations(), kTurns * kSteps) << "frames without a keyframe are no work";
    }
  }
}

}  // namespace
}  // namespace sgs::slam
