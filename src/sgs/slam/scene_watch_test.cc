// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/scene_watch.h"

#include <gtest/gtest.h>

#include <set>

namespace sgs::slam {
namespace {

using tracker::TrackingStatus;

constexpr double kPeriod_s = 1.0 / 30;

/// A camera before a wall, frame by frame; notes what is said.
class SceneWatchTest : public ::testing::Test {
 protected:
  /// `frames` more at `depth_m`, of which `missing` of the rows have no depth, `turn` rad apart.
  void look(int frames, float depth_m, double missing = 0, double turn = 0, std::uint8_t grey = 120,
            TrackingStatus status = TrackingStatus::kOk) {
    for (int i = 0; i < frames; ++i) {
      RgbdFrame frame;
      frame.index = count_;
      frame.timestamp_s = kPeriod_s * static_cast<double>(count_++);
      frame.camera = kCamera;
      frame.color = ColorImage(160, 120, {grey, grey, grey});
      frame.depth = DepthImage(160, 120, depth_m);
      for (int v = 0; v < static_cast<int>(120 * missing); ++v) {
        for (int u = 0; u < 160; ++u) frame.depth(u, v) = 0;
      }
      angle_ += turn;
      const SE3 T(Eigen::Quaterniond(Eigen::AngleAxisd(angle_, Eigen::Vector3d::UnitY())),
                  Eigen::Vector3d::Zero());
      for (const auto& change : watch_.add(frame, status, T, moving_)) {
        EXPECT_EQ(change.on, on_.insert(change.warning).second) << change.text;
        EXPECT_EQ(change.on, !change.text.empty());
        if (!change.on) on_.erase(change.warning);
        ++changes_;
      }
    }
  }

  static constexpr PinholeCamera kCamera{160, 120, 131, 131, 79.5, 59.5};
  SceneWatch watch_{kCamera};
  std::set<SceneWarning> on_;
  double moving_ = 0;
  int changes_ = 0;

 private:
  std::int64_t count_ = 0;
  double angle_ = 0;
};

using Warnings = std::set<SceneWarning>;

TEST_F(SceneWatchTest, SaysWhenMuchOfTheViewMoves) {
  look(60, 2);
  moving_ = 0.3;
  look(60, 2);
  EXPECT_EQ(on_, Warnings{});
  moving_ = 0.5;
  look(10, 2);
  EXPECT_EQ(on_, Warnings{SceneWarning::kCrowded});
  moving_ = 0;
  look(45, 2);
  EXPECT_EQ(on_, Warnings{});
}

TEST_F(SceneWatchTest, AQuietCameraHearsNothing) {
  look(300, 2, 0.1, 0.005);
  EXPECT_EQ(changes_, 0);
}

TEST_F(SceneWatchTest, AFastOneHearsItOnceAndThatItIsOverOnce) {
  look(60, 2);
  look(30, 2, 0, 0.12);
  EXPECT_EQ(on_, Warnings{SceneWarning::kTooFast});
  // Between the levels nothing flickers.
  look(30, 2, 0, 0.07);
  EXPECT_EQ(changes_, 1);
  look(60, 2, 0, 0.01);
  EXPECT_EQ(on_, Warnings{});
  EXPECT_EQ(changes_, 2);
}

TEST_F(SceneWatchTest, AJerkOfOneFrameIsNone) {
  look(30, 2);
  look(1, 2, 0, 0.3);
  look(30, 2);
  EXPECT_EQ(changes_, 0);
}

TEST_F(SceneWatchTest, WhatWasLeftOutSaysNothingAboutMotion) {
  look(30, 2);
  for (int k = 0; k < 10; ++k) {
    watch_.forget_motion();
    look(1, 2, 0, 0.3);
  }
  EXPECT_EQ(changes_, 0);
}

TEST_F(SceneWatchTest, DepthThatGoesMissingOnTheWayToAWallMeansTooNear) {
  look(120, 2);
  for (const float depth_m : {1.6F, 1.2F, 0.9F, 0.7F}) look(10, depth_m);
  look(30, 0.6F, 0.8);
  EXPECT_EQ(on_, Warnings{SceneWarning::kTooNear});
  look(30, 0.6F, 1, 0, 120, TrackingStatus::kLost);
  EXPECT_EQ(on_, Warnings{SceneWarning::kTooNear}) << "one reason is enough";
  look(60, 2);
  EXPECT_EQ(on_, Warnings{});
}

TEST_F(SceneWatchTest, DepthThatGoesMissingFarAwayMeansThatNothingIsSeen) {
  look(120, 2);
  look(30, 5, 0.95);
  EXPECT_EQ(on_, Warnings{SceneWarning::kNothingSeen});
  look(60, 2);
  EXPECT_EQ(on_, Warnings{});
}

TEST_F(SceneWatchTest, ACameraThatSeesLittleFromTheBeginningIsUsedToIt) {
  look(300, 2, 0.7);
  EXPECT_EQ(changes_, 0);
}

TEST_F(SceneWatchTest, NothingFromTheBeginningIsTold) {
  look(30, 0);
  EXPECT_EQ(on_, Warnings{SceneWarning::kNothingSeen});
}

TEST_F(SceneWatchTest, TheLightGoesOut) {
  look(120, 2);
  look(30, 2, 0, 0, 8);
  EXPECT_EQ(on_, Warnings{SceneWarning::kDark});
  look(60, 2);
  EXPECT_EQ(on_, Warnings{});
}

TEST_F(SceneWatchTest, WhatLastsBecomesUsual) {
  look(120, 2);
  look(30, 5, 0.95);
  EXPECT_EQ(on_, Warnings{SceneWarning::kNothingSeen});
  look(9000, 5, 0.95);
  EXPECT_EQ(on_, Warnings{});
}

TEST(Hysteresis, WhatIsNotMeasuredChangesNothing) {
  Hysteresis h({1, 0.5, 2, 0.1});
  EXPECT_FALSE(h.add(2, 0));
  EXPECT_TRUE(h.add(2, 0.1));
  EXPECT_TRUE(h.add(std::nan(""), 10));
  EXPECT_TRUE(h.add(0.7, 11));
  EXPECT_TRUE(h.add(0.1, 12));
  EXPECT_FALSE(h.add(0.1, 12.2));
}

}  // namespace
}  // namespace sgs::slam
