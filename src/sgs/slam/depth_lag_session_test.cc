// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "sgs/slam/session.h"

namespace sgs::slam {
namespace {

const PinholeCamera kLagCamera{80, 60, 67, 67, 39.5, 29.5};
constexpr double kFrame_s = 1.0 / 30, kDelay_s = 0.02;

/// To the right, so fast that the delay is many half pixels of slope.
SE3 pose_at_time(double time_s) {
  return {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(2.7 * time_s, 0, 0)};
}

/// Depth of the wall z = 2 + x / 2.
DepthImage wall_depth(const SE3& T) {
  DepthImage depth(kLagCamera.width, kLagCamera.height);
  for (int v = 0; v < kLagCamera.height; ++v) {
    for (int u = 0; u < kLagCamera.width; ++u) {
      const double x = kLagCamera.back_project(u, v, 1).x();
      depth(u, v) = static_cast<float>((2 + T.t.x() / 2) / (1 - x / 2));
    }
  }
  return depth;
}

/// Knows where the camera is, and keeps what it is given.
class KeepingTracker : public tracker::Tracker {
 public:
  KeepingTracker(bool knows_lag, std::vector<RgbdFrame>& given)
      : knows_lag_(knows_lag), given_(given) {}
  tracker::TrackResult track(const RgbdFrame& frame, const history::Revision&,
                             const map::SnapshotPtr&) override {
    given_.push_back(frame);
    tracker::TrackResult result;
    result.T_odom_camera = pose_at_time(frame.timestamp_s);
    return result;
  }
  bool follows_map() const override { return false; }
  bool knows_depth_lag() const override { return knows_lag_; }

 private:
  bool knows_lag_;
  std::vector<RgbdFrame>& given_;
};

std::vector<RgbdFrame> frames_given(bool knows_lag) {
  auto config = make_session_config("default");
  EXPECT_TRUE(config);
  config->mapper.iterations_per_frame = 0;
  std::vector<RgbdFrame> given;
  auto session =
      Session::create(*config, kLagCamera, {}, std::make_unique<KeepingTracker>(knows_lag, given));
  EXPECT_TRUE(session) << session.error().text();
  for (int i = 0; i < 5; ++i) {
    auto frame = std::make_shared<RgbdFrame>();
    frame->index = i;
    frame->timestamp_s = i * kFrame_s;
    frame->camera = kLagCamera;
    frame->color = ColorImage(kLagCamera.width, kLagCamera.height, {90, 100, 110});
    frame->depth = wall_depth(pose_at_time(frame->timestamp_s + kDelay_s));
    frame->depth_delay_s = kDelay_s;
    (*session)->feed(frame);
  }
  (*session)->finish();
  return given;
}

/// In the middle of the picture.
double depth_error(const RgbdFrame& frame, double delay_s) {
  const DepthImage want = wall_depth(pose_at_time(frame.timestamp_s + delay_s));
  return std::abs(double{frame.depth(40, 30)} - double{want(40, 30)});
}

TEST(DepthThatLags, IsLeftToATrackerThatKnowsOfIt) {
  const auto given = frames_given(true);
  ASSERT_EQ(given.size(), 5u);
  for (const RgbdFrame& frame : given) {
    EXPECT_EQ(frame.depth_delay_s, kDelay_s);
    EXPECT_LT(depth_error(frame, kDelay_s), 1e-6);
  }
}

TEST(DepthThatLags, IsMadeThatOfItsColoursTimeForOthers) {
  const auto given = frames_given(false);
  ASSERT_EQ(given.size(), 5u);
  for (const RgbdFrame& frame : given) {
    if (frame.index < 2) continue;  // how it moves is not known yet
    EXPECT_EQ(frame.depth_delay_s, 0);
    EXPECT_GT(depth_error(frame, kDelay_s), 0.018);
    EXPECT_LT(depth_error(frame, 0), 0.009);  // half a pixel of slope
  }
}

}  // namespace
}  // namespace sgs::slam
