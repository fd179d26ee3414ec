// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/back_end_worker.h"

#include <gtest/gtest.h>

namespace sgs::slam {
namespace {

/// Finds something at frame 3, and in the end, and counts what it has seen.
class FrameThree final : public BackEnd {
 public:
  std::optional<history::Update> add(const std::shared_ptr<const RgbdFrame>& frame,
                                     const tracker::TrackResult&,
                                     const history::Revision& revision) override {
    EXPECT_EQ(revision.path.back().frame, frame->index);
    ++seen_;
    if (frame->index != 3) return std::nullopt;
    return history::Update{PoseCorrection(std::vector<MovedPose>{{3, {}, {}}})};
  }
  std::optional<history::Update> finish(const history::Revision&) override {
    return history::Update{PoseCorrection(std::vector<MovedPose>{{9, {}, {}}})};
  }
  int found() const override { return seen_; }

 private:
  int seen_ = 0;
};

class BackEndWorkerTest : public testing::TestWithParam<WorkerMode> {
 protected:
  void feed(std::int64_t index) {
    const auto frame = std::make_shared<RgbdFrame>();
    frame->index = index;
    revision_.path.append({index, 0, {}});
    worker_.submit(frame, {}, revision_);
  }
  history::Revision revision_;
  BackEndWorker worker_{std::make_unique<FrameThree>(), 2, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Modes, BackEndWorkerTest,
                         testing::Values(WorkerMode::kInline, WorkerMode::kThread));

TEST_P(BackEndWorkerTest, WhatAFrameGaveIsThereALagLater) {
  for (std::int64_t n = 0; n < 10; ++n) {
    worker_.wait_before(n);
    EXPECT_EQ(worker_.take_before(n).has_value(), n == 5) << n;
    EXPECT_EQ(worker_.found_before(n), std::max<std::int64_t>(0, n - 1)) << n;
    feed(n);
  }
  const auto last = worker_.finish(revision_);
  ASSERT_TRUE(last);
  EXPECT_EQ(last->poses.poses()[0].timestamp_s, 9);
}

TEST_P(BackEndWorkerTest, WhatNobodyTakesWaits) {
  for (std::int64_t n = 0; n < 8; ++n) {
    worker_.wait_before(n);
    feed(n);
  }
  worker_.wait_before(8);
  EXPECT_TRUE(worker_.take_before(8));
  EXPECT_FALSE(worker_.take_before(8));
}

TEST_P(BackEndWorkerTest, TheEndFindsWhatNobodyTook) {
  for (std::int64_t n = 0; n < 5; ++n) feed(n);
  const auto last = worker_.finish(revision_);
  ASSERT_TRUE(last);
  EXPECT_EQ(last->poses.poses()[0].timestamp_s, 3);
}

}  // namespace
}  // namespace sgs::slam
