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

// A keyframe of the session has one turn, the view of the old map several, in all no more steps
// than the session has made.
TEST(MapWorker, CatchesUpWithTheViewsOfAMapThatIsGoneOnWith) {
  auto config = make_session_config("default");
  ASSERT_TRUE(config);
  const auto old = mapper::wall_frame(mapper::small_camera(), SE3{});
  RgbdFrame now = *old;
  now.index = old->index + 1;
  now.timestamp_s = old->timestamp_s + 1;
  mapper::Mapper before(config->mapper, old->camera, 0, nullptr);
  before.add_keyframe(old, SE3{});
  const auto known = before.snapshot()->gaussians;
  config->mapper.iterations_per_frame = 2;
  const auto steps = [&](double frames, bool catches_up) {
    history::Revision revision;
    revision.path.append({old->index, old->timestamp_s, SE3{}});
    MapWorker worker(*config, old->camera, false, WorkerMode::kInline, 1);
    worker.know(known, std::vector<std::int32_t>(known.size(), 0),
                {{std::make_shared<history::StoredView>(*old), Vector6d::Zero(), SE3{}, SE3{}}},
                revision);
    revision.path.append({now.index, now.timestamp_s, SE3{}});
    worker.submit({std::make_shared<RgbdFrame>(now), revision, frames});
    ++revision.loops;
    MapJob last;
    last.revision = revision;
    last.catches_up = catches_up;
    last.frames = 0;
    worker.submit(std::move(last));
    worker.finish();
    return worker.iterations();
  };
  EXPECT_EQ(steps(20, false), 40);
  EXPECT_EQ(steps(20, true), 40 + 2 + 8 * 2);
  EXPECT_EQ(steps(3, true), 6 + 2 + 6) << "no more than the session has made";
}

// Live steps are made as time allows; nobody waits for them any more then.
TEST(MapWorker, CatchesUpLive) {
  EXPECT_LT(steps_with(WorkerMode::kLive, {.is_revised = false}), kStepsPerFrame);
  EXPECT_GE(steps_with(WorkerMode::kLive, {.is_revised = true}), kStepsPerFrame);
}

}  // namespace
}  // namespace sgs::slam
