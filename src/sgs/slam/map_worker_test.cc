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

constexpr int kStepsPerFrame = 40;

struct LastJobs {
  bool is_revised = false;  // after the only keyframe
  int frames_after = 0;
  bool catches_up = true;
};

std::int64_t steps_with(WorkerMode mode, const LastJobs& jobs) {
  auto config = make_session_config("default");
  EXPECT_TRUE(config);
  config->mapper.iterations_per_frame = kStepsPerFrame;
  const auto frame = mapper::wall_frame(mapper::small_camera(), SE3{});
  history::Revision revision;
  revision.path.append({frame->index, frame->timestamp_s, SE3{}});
  MapWorker worker(*config, frame->camera, false, mode, 1);
  worker.submit({frame, revision});
  if (jobs.is_revised) ++revision.loops;
  for (int k = 0; k < jobs.frames_after; ++k) worker.submit({nullptr, revision});
  MapJob last;
  last.revision = revision;
  last.catches_up = true;
  if (jobs.catches_up) worker.submit(std::move(last));
  worker.finish();
  return worker.iterations();
}

// What a revision has moved is learnt again, though no frame comes any more.
TEST(MapWorker, CatchesUpAfterTheLastFrameWithWhatARevisionHasMoved) {
  const auto steps = [](LastJobs jobs) {
    const auto all = steps_with(WorkerMode::kInline, jobs);
    jobs.catches_up = false;
    return all - steps_with(WorkerMode::kInline, jobs);
  };
  EXPECT_EQ(steps({.is_revised = false}), 0);
  EXPECT_EQ(steps({.is_revised = true}), kStepsPerFrame);
  EXPECT_EQ(steps({.is_revised = true, .frames_after = 1}), 0) << "a frame's steps came after";
}

// Live steps are made as time allows; nobody waits for them any more then.
TEST(MapWorker, CatchesUpLive) {
  EXPECT_LT(steps_with(WorkerMode::kLive, {.is_revised = false}), kStepsPerFrame);
  EXPECT_GE(steps_with(WorkerMode::kLive, {.is_revised = true}), kStepsPerFrame);
}

}  // namespace
}  // namespace sgs::slam
