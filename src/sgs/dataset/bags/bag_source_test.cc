// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole recordings of foreign writers are in tests/bags; here are the parts that put them in order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sgs/dataset/bags/bag_pairs.h"
#include "sgs/dataset/bags/bag_time.h"
#include "sgs/dataset/bags/bag_transforms.h"
#include "sgs/dataset/bags/test_bag.h"
#include "sgs/dataset/imu.h"

namespace sgs::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

struct TwoStreams {
  MemoryBag bag;
  std::size_t color = bag.topic("/c", "sensor_msgs/Image");
  std::size_t depth = bag.topic("/d", "sensor_msgs/Image");

  /// Colour times in ms of what comes out; "bad" events are negative.
  std::vector<int> run(double tolerance_s = 0.02) {
    BagPairs pairs(bag, color, depth, BagClock::kStamp, tolerance_s);
    std::vector<int> times;
    while (true) {
      const auto event = pairs.next();
      if (event.kind == BagPairs::Event::Kind::kEnd) break;
      const bool bad = event.kind == BagPairs::Event::Kind::kBad;
      times.push_back(bad ? -1 : static_cast<int>(event.time_ns / kMs));
      if (bad) problem = event.error.message;
    }
    unpaired = {pairs.color_without_depth(), pairs.depth_without_color()};
    return times;
  }
  std::string problem;
  std::pair<std::size_t, std::size_t> unpaired;
};

TEST(BagPairs, NearestDepthOfAFasterCameraIsTaken) {
  TwoStreams s;
  for (const int ms : {0, 33, 66}) s.bag.stamp(s.color, ms);
  for (const int ms : {0, 11, 22, 34, 45, 56, 65}) s.bag.stamp(s.depth, ms);
  EXPECT_THAT(s.run(), ElementsAre(0, 33, 66));
  EXPECT_EQ(s.unpaired, std::pair(std::size_t{0}, std::size_t{4}));
}

TEST(BagPairs, OrderInTheFileDoesNotMatter) {
  TwoStreams s;
  for (const int ms : {33, 0, 66, 133, 100}) s.bag.stamp(s.color, ms);
  for (const int ms : {0, 33, 66, 100, 133}) s.bag.stamp(s.depth, ms);
  EXPECT_THAT(s.run(), ElementsAre(0, 33, 66, 100, 133));
}

TEST(BagPairs, GapsLeaveOthersAlone) {
  TwoStreams s;
  for (int i = 0; i < 60; ++i) s.bag.stamp(s.color, 33 * i);
  for (int i = 40; i < 100; ++i) s.bag.stamp(s.depth, 33 * i);
  const auto times = s.run();
  ASSERT_EQ(times.size(), 20u);
  EXPECT_EQ(times.front(), 33 * 40);
  EXPECT_EQ(s.unpaired.first, 40u);
}

TEST(BagPairs, ColourThatRepeatsOrGoesBackIsSaid) {
  TwoStreams s;
  for (const int ms : {5000, 5033, 5033, 5066, 1000, 5100}) s.bag.stamp(s.color, ms);
  for (const int ms : {5000, 5033, 5066, 5100}) s.bag.stamp(s.depth, ms);
  auto times = s.run();
  EXPECT_EQ(std::count(times.begin(), times.end(), -1), 2);
  times.erase(std::remove(times.begin(), times.end(), -1), times.end());
  EXPECT_THAT(times, ElementsAre(5000, 5033, 5066, 5100));
  EXPECT_THAT(s.problem, HasSubstr("1.000000 s"));
}

TEST(BagPairs, AClockThatIsSetBackBeginsANewStretch) {
  TwoStreams s;
  for (const int start : {20'000, 10'000, 10'200}) {
    // Ten seconds are set back once: nothing is lost.
    for (int i = 0; i < 5; ++i) {
      s.bag.stamp(s.color, start + 40 * i);
      s.bag.stamp(s.depth, start + 40 * i + 5);
    }
  }
  BagPairs pairs(s.bag, s.color, s.depth, BagClock::kStamp, 0.02);
  std::vector<std::int64_t> times, stamps;
  int back = 0;
  for (auto event = pairs.next(); event.kind != BagPairs::Event::Kind::kEnd; event = pairs.next()) {
    if (event.kind == BagPairs::Event::Kind::kBack) {
      ++back;
      EXPECT_THAT(event.error.message, HasSubstr("set back by 10.200 s"));
      continue;
    }
    ASSERT_EQ(event.kind, BagPairs::Event::Kind::kPair);
    times.push_back(event.time_ns / kMs);
    stamps.push_back(event.stamp_ns / kMs);
    EXPECT_EQ(event.moved, event.stamp_ns < 20'000 * kMs);
  }
  EXPECT_EQ(back, 1);
  EXPECT_THAT(stamps, ElementsAre(20000, 20040, 20080, 20120, 20160, 10000, 10040, 10080, 10120,
                                  10160, 10200, 10240, 10280, 10320, 10360));
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_EQ(times[i] - times[i - 1], 40) << i;
}

TEST(BagPairs, AClockThatIsSetBackByLittleBeginsANewStretch) {
  TwoStreams s;
  for (const int start : {20'000, 19'970}) {
    for (int i = 0; i < 12; ++i) {
      s.bag.stamp(s.color, start + 40 * i);
      s.bag.stamp(s.depth, start + 40 * i + 5);
    }
  }
  const auto times = s.run();
  EXPECT_EQ(times.size(), 25u);  // one says that the clock was set back
}

TEST(BagPairs, StampsOfAnotherAgeCostTheirImages) {
  TwoStreams s;
  constexpr int kAge = 2'000'000'000;
  for (const int ms : {0, 33, kAge, kAge + 33, kAge + 66, kAge + 100}) {
    s.bag.stamp(s.color, ms);
    s.bag.stamp(s.depth, ms);
  }
  auto times = s.run();
  times.erase(std::remove(times.begin(), times.end(), -1), times.end());
  EXPECT_THAT(times, ElementsAre(kAge, kAge + 33, kAge + 66, kAge + 100));
}

TEST(BagPairs, OneStampFarAheadCostsOneImage) {
  TwoStreams s;
  for (const int ms : {5000, 5033, 900'000, 5066, 5100, 5133}) s.bag.stamp(s.color, ms);
  for (const int ms : {5000, 5033, 5066, 5100, 5133}) s.bag.stamp(s.depth, ms);
  auto times = s.run();
  EXPECT_EQ(std::count(times.begin(), times.end(), -1), 1);
  times.erase(std::remove(times.begin(), times.end(), -1), times.end());
  EXPECT_THAT(times, ElementsAre(5000, 5033, 5066, 5100, 5133));
}

TEST(BagPairs, DamageIsOneBadFrameAndReadingGoesOn) {
  TwoStreams s;
  for (const int ms : {0, 33}) s.bag.stamp(s.color, ms), s.bag.stamp(s.depth, ms);
  s.bag.damage();
  for (const int ms : {66, 100}) s.bag.stamp(s.color, ms), s.bag.stamp(s.depth, ms);
  auto times = s.run();
  EXPECT_EQ(std::count(times.begin(), times.end(), -1), 1);
  times.erase(std::remove(times.begin(), times.end(), -1), times.end());
  EXPECT_THAT(times, ElementsAre(0, 33, 66, 100));
}

TEST(BagPairs, NeverTogetherIsCountedAndMeasured) {
  TwoStreams s;
  for (int i = 0; i < 20; ++i) s.bag.stamp(s.color, 33 * i), s.bag.stamp(s.depth, 10000 + 33 * i);
  EXPECT_THAT(s.run(), ElementsAre());
  BagPairs pairs(s.bag, s.color, s.depth, BagClock::kStamp, 0.02);
  while (pairs.next().kind != BagPairs::Event::Kind::kEnd) {
  }
  ASSERT_TRUE(pairs.nearest_ns());
  EXPECT_EQ(*pairs.nearest_ns(), (10000 - 33 * 19) * kMs);
  BagPairs impatient(s.bag, s.color, s.depth, BagClock::kStamp, 0.02);
  impatient.give_up_after(3);
  EXPECT_EQ(impatient.next().kind, BagPairs::Event::Kind::kEnd);
  EXPECT_EQ(impatient.color_without_depth(), 3u);
}

TEST(BagTime, IsTheDoubleThatTextGives) {
  EXPECT_EQ(seconds_of(1305031102'175304000), 1305031102.175304);
  EXPECT_EQ(seconds_of(1'033333333), 1.033333333);
  EXPECT_EQ(seconds_of(-500'000'000), -0.5);
  EXPECT_EQ(seconds_of(0), 0);
}

std::string packed_transform(std::int64_t ms, const std::string& parent, const std::string& child,
                             const SE3& T) {
  const Eigen::Quaterniond q = T.quaternion();
  std::string bytes = packed(1u) + packed_header(ms * kMs, parent) + packed_text(child);
  for (const double v : {T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w()}) {
    bytes += packed(v);
  }
  return bytes;
}

SE3 at(double x, double angle = 0) { return {so3_exp({0, 0, angle}), {x, 0, 0}}; }

TEST(TransformTree, JoinsFramesThroughTheirCommonParent) {
  MemoryBag bag;
  const auto fixed = bag.topic("/tf_static", "tf2_msgs/TFMessage");
  bag.add(fixed, packed_transform(0, "link", "color", at(0.05, 0.1)));
  bag.add(fixed, packed_transform(0, "/link", "depth", at(-0.01, -0.2)));
  bag.add(fixed, packed_transform(0, "elsewhere", "other", at(1)));
  const auto tree = TransformTree::read(bag, false);
  ASSERT_TRUE(tree);
  const auto T = tree->fixed("color", "depth");
  ASSERT_TRUE(T);
  const SE3 expected = at(0.05, 0.1).inverse() * at(-0.01, -0.2);
  EXPECT_TRUE(T->R.isApprox(expected.R));
  EXPECT_TRUE(T->t.isApprox(expected.t));
  EXPECT_FALSE(tree->fixed("color", "other"));
  EXPECT_FALSE(tree->fixed("color", "nowhere"));
  EXPECT_THAT(tree->frames(), HasSubstr("elsewhere"));
}

TEST(TransformTree, NamespacesCountAndWhatIsNoTransformIsLeftOut) {
  MemoryBag bag;
  const auto fixed = bag.topic("/robot0/tf_static", "tf2_msgs/TFMessage");
  bag.add(fixed, "damaged");
  bag.add(fixed, packed_transform(0, "link", "color", at(0.05)));
  std::string none = packed_transform(0, "link", "accelerometer", at(0));
  for (std::size_t i = none.size() - 32; i < none.size(); ++i) none[i] = '\0';  // its quaternion
  bag.add(fixed, none);
  bag.add(fixed, packed_transform(0, "link", "depth", at(-0.01)));
  const auto tree = TransformTree::read(bag, false);
  ASSERT_TRUE(tree) << tree.error().text();
  const auto T = tree->fixed("color", "depth");
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->t.x(), -0.06, 1e-12);
  ASSERT_EQ(tree->warnings().size(), 2u);
  EXPECT_THAT(tree->warnings()[0], HasSubstr("1 messages left out"));
  EXPECT_THAT(tree->warnings()[1], HasSubstr("accelerometer"));
}

TEST(TransformTree, MovingFramesAreFollowedAndCyclesEnd) {
  MemoryBag bag;
  const auto fixed = bag.topic("/tf_static", "tf2_msgs/TFMessage");
  const auto moving = bag.topic("/tf", "tf2_msgs/TFMessage");
  bag.add(fixed, packed_transform(0, "body", "camera", at(0.5)));
  for (int i = 0; i < 5; ++i) bag.add(moving, packed_transform(100 * i, "world", "body", at(i)));
  bag.add(moving, packed_transform(0, "a", "b", at(1)));
  bag.add(moving, packed_transform(0, "b", "a", at(1)));
  const auto tree = TransformTree::read(bag, true);
  ASSERT_TRUE(tree);
  const auto poses = tree->moving("world", "camera", 0.15);
  ASSERT_EQ(poses.size(), 5u);
  EXPECT_DOUBLE_EQ(poses.poses()[3].timestamp_s, 0.3);
  EXPECT_TRUE(poses.poses()[3].T_world_camera.t.isApprox(Eigen::Vector3d(3.5, 0, 0)));
  EXPECT_TRUE(tree->moving("world", "a", 0.15).empty());
}

/// sensor_msgs/Imu; what is not measured has -1 in its covariance.
std::string packed_imu(std::int64_t ms, const std::string& frame, const Eigen::Vector3d& turn,
                       const Eigen::Vector3d& acceleration, double first_of_acceleration = 0) {
  std::string bytes = packed_header(ms * kMs, frame);
  const auto add = [&](std::initializer_list<double> values) {
    for (const double v : values) bytes += packed(v);
  };
  add({0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0, 0, 0});
  add({turn.x(), turn.y(), turn.z(), 0, 0, 0, 0, 0, 0, 0, 0, 0});
  add({acceleration.x(), acceleration.y(), acceleration.z()});
  add({first_of_acceleration, 0, 0, 0, 0, 0, 0, 0, 0});
  return bytes;
}

TEST(BagImu, IsTheTopicThatMeasuresAccelerationsInTheAxesThatTfSays) {
  MemoryBag bag;
  const auto gyro = bag.topic("/gyro", "sensor_msgs/Imu");
  const auto foreign = bag.topic("/base_imu", "sensor_msgs/Imu");
  const auto imu = bag.topic("/imu", "sensor_msgs/Imu");
  const auto fixed = bag.topic("/tf_static", "tf2_msgs/TFMessage");
  bag.add(fixed, packed_transform(0, "color", "imu_frame", at(0.02, 0.5)));
  bag.add(gyro, packed_imu(1, "imu_frame", {0.1, 0, 0}, {0, 0, 0}));
  bag.add(foreign, packed_imu(1, "base", {0, 0, 0}, {0, 0, 9.8}));
  bag.add(imu, packed_imu(100, "imu_frame", {0.1, 0.2, 0.3}, {1, 2, 9}));
  bag.add(imu, packed_imu(0, "imu_frame", {0, 0, 0}, {1, 2, 9.5}), 7 * 1'000'000'000LL);
  bag.add(imu, packed_imu(300, "imu_frame", {0, 0, 0}, {4, 4, 4}, -1));
  bag.add(imu, "cut off");
  const ImuRecording read = read_bag_imu(bag, "color");
  EXPECT_EQ(read.source, "/imu");
  ASSERT_TRUE(read.R_camera_imu);
  EXPECT_TRUE(read.R_camera_imu->isApprox(at(0, 0.5).R));
  ASSERT_EQ(read.samples.size(), 2u);
  EXPECT_DOUBLE_EQ(read.samples[0].timestamp_s, 0.1);
  EXPECT_EQ(read.samples[0].acceleration, Eigen::Vector3d(1, 2, 9));
  EXPECT_EQ(read.samples[0].angular_velocity_rad_s, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_DOUBLE_EQ(read.samples[1].timestamp_s, 7);  // without a stamp, when it was written
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("/imu: a message is no sensor_msgs/Imu")));
}

TEST(BagImu, OfUnknownMountingIsReadAllTheSame) {
  MemoryBag bag;
  EXPECT_TRUE(read_bag_imu(bag, "color").source.empty());
  bag.add(bag.topic("/imu", "sensor_msgs/Imu"), packed_imu(1, "imu", {0, 0, 0}, {0, 0, 9.8}));
  const ImuRecording read = read_bag_imu(bag, "color");
  EXPECT_EQ(read.samples.size(), 1u);
  EXPECT_FALSE(read.R_camera_imu);
}

}  // namespace
}  // namespace sgs::dataset
