// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/online_calibration.h"

#include <gtest/gtest.h>

#include <optional>

#include "sgs/backend/test_room.h"

namespace sgs::backend {
namespace {

BackendConfig quick_config() {
  BackendConfig config;
  config.archive.view_distance = 0.02;
  config.calibration.columns = 8;
  config.calibration.rows = 6;
  config.calibration.keyframes = 36;
  return config;
}

struct Lesson {
  int frame;
  LearnedCalibration learned;
};

/// What is learned from views of a room that come with slightly wrong poses; every update is a
/// revision at once. `scale`: of the tracked path, as the distorted depth made it.
std::vector<Lesson> lessons(const TestRoom& room, double scale = 1) {
  constexpr int kFrames = 26;
  OnlineCalibration calibration(quick_config());
  history::Revision now;
  std::vector<Lesson> out;
  for (int k = 0; k < kFrames; ++k) {
    now.path.append({k, k / 30.0, TestRoom::tracked_pose(k, scale)});
    if (auto learned = calibration.add(room.view(k), now, 0)) {
      now = history::revised(now, learned->update);
      out.push_back({k, std::move(*learned)});
    }
  }
  EXPECT_EQ(calibration.versions(), static_cast<int>(out.size()));
  return out;
}

/// What is learned at the end of so few views that there was one attempt, which nothing confirmed.
std::optional<LearnedCalibration> last_lesson(const TestRoom& room, double scale = 1) {
  constexpr int kFrames = 11;
  OnlineCalibration calibration(quick_config());
  history::Revision now;
  for (int k = 0; k < kFrames; ++k) {
    now.path.append({k, k / 30.0, TestRoom::tracked_pose(k, scale)});
    EXPECT_FALSE(calibration.add(room.view(k), now, 0));
  }
  auto learned = calibration.finish(now);
  EXPECT_EQ(calibration.versions(), learned ? 1 : 0);
  EXPECT_FALSE(calibration.finish(now)) << "asked twice";
  return learned;
}

TEST(OnlineCalibration, WhatNoAttemptWasSureOfIsAskedAtTheEnd) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  const auto learned = last_lesson(room);
  ASSERT_TRUE(learned);
  EXPECT_NEAR(learned->estimate.calibration.mean_offset_per_m(), 0.006, 1e-3);
  EXPECT_GE(learned->update.poses.poses().size(), 8u);
  EXPECT_FALSE(last_lesson({})) << "a camera that is right";
  room.distort = [](double, double, double q) { return q - 0.03; };
  EXPECT_FALSE(last_lesson(room, 1.06)) << "another metre";
}

TEST(OnlineCalibration, LearnsWhileItGoesOn) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  const auto learned = lessons(room);
  ASSERT_FALSE(learned.empty());
  EXPECT_NEAR(learned.back().learned.estimate.calibration.mean_offset_per_m(), 0.006, 6e-4);
  // Not before a second attempt has confirmed the first.
  EXPECT_GE(learned.front().frame, 12);
  const history::Update& first = learned.front().learned.update;
  ASSERT_TRUE(first.calibration);
  EXPECT_NEAR(history::depth_change({}, first.calibration)->rms_per_m(), 0.006, 1e-3);
  EXPECT_GE(first.poses.poses().size(), 12u);
  // What comes later is near what was there.
  for (std::size_t i = 1; i < learned.size(); ++i) {
    const auto &before = learned[i - 1].learned.update, &after = learned[i].learned.update;
    EXPECT_LT(history::depth_change(before.calibration, after.calibration)->rms_per_m(), 2e-3);
  }
}

TEST(OnlineCalibration, SaysNothingOfACameraThatIsRight) { EXPECT_TRUE(lessons({}).empty()); }

TEST(OnlineCalibration, IsOnlyConfirmedByWhatItExpects) {
  DepthCalibration earlier;
  earlier.camera = TestRoom{}.camera;
  earlier.grid = {8, 6};
  earlier.offset_per_m.assign(48, 0.002);
  earlier.sigma_per_m.assign(48, 5e-4);
  earlier.mean_sigma_per_m = 3e-4;
  earlier.shift_px = {1.5, 0};
  earlier.shift_sigma_px = {0.2, 0.2};
  EXPECT_TRUE(confirms(earlier, earlier));
  DepthCalibration later = earlier;
  later.shift_px = {1.9, -0.3};
  later.offset_per_m.assign(48, 0.0025);
  EXPECT_TRUE(confirms(later, earlier));
  later.shift_px = {2.5, 0};
  EXPECT_FALSE(confirms(later, earlier)) << "another shift";
  later = earlier;
  later.offset_per_m.assign(48, 0.004);
  EXPECT_FALSE(confirms(later, earlier)) << "another mean";
  later = earlier;
  later.delay_s = 0.002;
  EXPECT_FALSE(confirms(later, earlier)) << "another delay";
  later = earlier;
  for (std::size_t k = 0; k < 48; ++k) later.offset_per_m[k] += k % 2 == 0 ? 0.002 : -0.002;
  EXPECT_FALSE(confirms(later, earlier)) << "another shape";
}

TEST(OnlineCalibration, DepthOfAnotherMetreIsNotBentStraight) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.03; };
  EXPECT_TRUE(lessons(room, 1.06).empty());
}

TEST(OnlineCalibration, APathOfAnotherLengthAloneIsNoContradiction) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.002; };
  EXPECT_FALSE(lessons(room, 1.03).empty());
}

TEST(OnlineCalibration, WaitsUntilWhatItSaidIsApplied) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  OnlineCalibration calibration(quick_config());
  history::Revision now;
  int learned = 0;
  for (int k = 0; k < 26; ++k) {
    now.path.append({k, k / 30.0, TestRoom::tracked_pose(k)});
    learned += calibration.add(room.view(k), now, 0) ? 1 : 0;
  }
  EXPECT_EQ(learned, 1);
}

TEST(OnlineCalibration, FramesThatWereLostTellNothing) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  OnlineCalibration calibration(quick_config());
  history::Revision now;
  for (int k = 0; k < 20; ++k) {
    now.path.append({k, k / 30.0, TestRoom::tracked_pose(k)});
    calibration.note_gap();
    EXPECT_FALSE(calibration.add(room.view(k), now, 0));
  }
  EXPECT_FALSE(calibration.finish(now));
}

}  // namespace
}  // namespace sgs::backend
