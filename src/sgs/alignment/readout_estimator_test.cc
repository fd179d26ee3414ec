// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/readout_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace sgs::alignment {
namespace {

Vector6d shaky_rate(int frame) {
  Vector6d rate = Vector6d::Zero();
  rate.head<3>() << 0.3 * std::sin(0.21 * frame), 0.25 * std::cos(0.17 * frame),
      0.2 * std::sin(0.13 * frame + 1);
  return rate;
}

// Feeds `frames` frames of a sensor with the given readout time, a keyframe every `interval` of
// them that takes over what is estimated, turning `speed` times as fast; returns the error of the
// last keyframe's turn.
Eigen::Vector3d run(ReadoutEstimator& estimator, double readout_s, int frames, int interval,
                    double noise_rad, double speed = 1) {
  std::mt19937_64 random(7);
  const auto noise = [&]() -> Eigen::Vector3d {
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
    return Eigen::Vector3d(unit(), unit(), unit()) * std::sqrt(12.0) * noise_rad;
  };
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  std::size_t keyframe = 0;
  const Eigen::Matrix3d information = Eigen::Matrix3d::Identity() * 1e8;
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d rate = speed * shaky_rate(i).head<3>();
    const Eigen::Vector3d turn = readout_s * rate + noise();
    const Eigen::Vector3d seen = turn + error;
    estimator.update(rate, seen, information, keyframe);
    if (i % interval != interval - 1) continue;
    const Eigen::Vector3d taken_for = seen - estimator.keyframe_error(keyframe);
    error = taken_for - turn;
    estimator.add_keyframe(++keyframe, rate, taken_for);
  }
  return error;
}

TEST(ReadoutEstimator, LearnsTheReadoutTimeOfTheSensor) {
  for (const double truth : {0.0, 0.016, 0.03, -0.02}) {
    ReadoutEstimator estimator(ReadoutConfig{});
    EXPECT_EQ(estimator.readout_s(), 0);
    run(estimator, truth, 200, 10, 5e-4);
    EXPECT_NEAR(estimator.readout_s(), truth, 1e-3) << truth;
  }
}

TEST(ReadoutEstimator, ErrorsOfKeyframesDoNotAddUp) {
  ReadoutEstimator estimator(ReadoutConfig{});
  EXPECT_LT(run(estimator, 0.016, 2000, 8, 1e-3).norm(), 4e-3);
}

// Little beside what its keyframes are taken for wrongly, and each lives for a few frames only.
TEST(ReadoutEstimator, LearnsFromSlowTurnsToo) {
  constexpr double kReadout_s = 0.016, kSlow = 0.4;
  ReadoutEstimator estimator(ReadoutConfig{});
  run(estimator, kReadout_s, 100, 6, 2e-4, kSlow);
  EXPECT_NEAR(estimator.readout_s(), kReadout_s, 2e-3);
}

// Keyframe and frames are bent alike while the camera turns steadily. That is no evidence for a
// global shutter: when the rate changes, the readout time is learned from that.
TEST(ReadoutEstimator, ASteadyTurnSaysNothing) {
  constexpr double kReadout_s = 0.016;
  const Eigen::Matrix3d information = Eigen::Matrix3d::Identity() * 1e8;
  const Eigen::Vector3d steady(0, 0.5, 0), back(0, -0.3, 0.1);
  ReadoutEstimator estimator(ReadoutConfig{});
  estimator.add_keyframe(0, steady, {0, 0, 0});
  for (int i = 0; i < 300; ++i) estimator.update(steady, {0, 0, 0}, information, 0);
  EXPECT_EQ(estimator.readout_s(), 0);
  Vector6d velocity = Vector6d::Zero();
  velocity.head<3>() = back;
  EXPECT_LT(estimator.predict(velocity, 0).information(0, 0), 1 / (2e-3 * 2e-3)) << "not known yet";
  for (int i = 0; i < 30; ++i) {
    estimator.update(back, kReadout_s * (back - steady), information, 0);
  }
  EXPECT_NEAR(estimator.readout_s(), kReadout_s, 1e-3);
  EXPECT_LT((estimator.keyframe_error(0) + kReadout_s * steady).norm(), 1e-3);
}

TEST(ReadoutEstimator, AGlobalShutterLeavesNoFreedom) {
  ReadoutEstimator estimator(ReadoutConfig{});
  run(estimator, 0.0, 300, 10, 1e-4);
  const auto belief = estimator.predict(shaky_rate(3), 1000);
  EXPECT_LT(belief.mean.norm(), 3e-4);
  EXPECT_GT(belief.information(0, 0), 1 / (3e-4 * 3e-4));
}

TEST(ReadoutEstimator, AShakingHandLeavesMoreFreedomThanASteadyOne) {
  ReadoutEstimator steady(ReadoutConfig{}), shaking(ReadoutConfig{});
  run(steady, 0.02, 300, 10, 1e-4);
  run(shaking, 0.02, 300, 10, 2e-3);
  const auto information = [](const ReadoutEstimator& estimator) {
    return estimator.predict(shaky_rate(3), 1000).information(0, 0);
  };
  EXPECT_GT(information(steady), 1 / (4e-4 * 4e-4));
  EXPECT_GT(information(steady), 20 * information(shaking));
}

TEST(ReadoutEstimator, FixedTimeIsTakenAsItIs) {
  ReadoutConfig config;
  config.estimate = false;
  config.fixed_s = 0.02;
  ReadoutEstimator estimator(config);
  run(estimator, 0.0, 50, 10, 0);
  EXPECT_EQ(estimator.readout_s(), 0.02);
  EXPECT_LT((estimator.predict(shaky_rate(5), 0).mean - 0.02 * shaky_rate(5)).norm(), 1e-15);
}

TEST(ReadoutEstimator, IgnoresWhatIsNotANumber) {
  ReadoutEstimator estimator(ReadoutConfig{});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  estimator.update({nan, 0, 0}, {0, 0, 0}, Eigen::Matrix3d::Identity(), 0);
  estimator.update({1, 0, 0}, {0, nan, 0}, Eigen::Matrix3d::Identity(), 0);
  estimator.update({1, 0, 0}, {0, 0, 0}, Eigen::Matrix3d::Zero(), 0);
  EXPECT_EQ(estimator.readout_s(), 0);
}

}  // namespace
}  // namespace sgs::alignment
