// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sgs/slam/session.h"
#include "sgs/synthetic/source.h"

namespace sgs {
namespace {

/// Knows the truth, and loses the frames it is told to lose.
class TruthTracker : public tracker::Tracker {
 public:
  explicit TruthTracker(std::int64_t lost_index) : lost_index_(lost_index) {}
  tracker::TrackResult track(const RgbdFrame& frame, const history::Revision&,
                             const map::SnapshotPtr&) override {
    tracker::TrackResult result;
    result.T_odom_camera = *frame.truth_T_world_camera;
    if (frame.index == lost_index_) {
      result.status = tracker::TrackingStatus::kLost;
      result.lost_reason = alignment::LostReason::kOther;
    }
    return result;
  }
  bool follows_map() const override { return false; }

 private:
  std::int64_t lost_index_;
};

slam::SessionConfig config_for_test() {
  auto config = slam::make_session_config("default");
  EXPECT_TRUE(config);
  config->keyframe_interval = 3;
  return *config;
}

TEST(OwnTracker, SessionMapsWithItsPosesAndBelievesItsStatus) {
  synthetic::SynthOptions options;
  options.scene = "room_desk";
  options.frames = 8;
  options.camera = {160, 120, 133.8, 134.8, 79.9, 61.8};
  const auto source = synthetic::make_synthetic_source(options);
  ASSERT_TRUE(source) << source.error().text();
  auto session = slam::Session::create(config_for_test(), options.camera, {},
                                       std::make_unique<TruthTracker>(6));
  ASSERT_TRUE(session) << session.error().text();

  std::vector<SE3> truth;
  for (auto frame = std::make_shared<RgbdFrame>();; frame = std::make_shared<RgbdFrame>()) {
    Error error;
    if ((*source)->next(*frame, error) != dataset::FrameRead::kOk) break;
    truth.push_back(*frame->truth_T_world_camera);
    (*session)->feed(frame);
  }
  (*session)->finish();

  // Keyframes after frames 0 and 3; the next one was due at the lost frame and waits for frame 7.
  std::vector<std::int64_t> keyframes;
  for (const auto& record : (*session)->records().all()) {
    if (record.mapping_keyframe) keyframes.push_back(record.index);
  }
  EXPECT_EQ(keyframes, (std::vector<std::int64_t>{0, 3, 7}));
  EXPECT_EQ((*session)->records().all()[6].lost_reason, alignment::LostReason::kOther);
  EXPECT_GT((*session)->snapshot()->gaussians.size(), 100u);
  const Trajectory trajectory = (*session)->trajectory();
  ASSERT_EQ(trajectory.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((trajectory.poses()[i].T_world_camera.t - truth[i].t).norm(), 0.01) << i;
  }
}

TEST(OwnTracker, ThereMustBeOne) {
  EXPECT_THROW(
      (void)slam::Session::create(config_for_test(), {160, 120, 134, 134, 79.5, 59.5}, {}, nullptr),
      ContractViolation);
}

}  // namespace
}  // namespace sgs
