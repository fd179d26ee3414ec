// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/delay_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

namespace sgs::tracker {
namespace {

class RandomSums {
 public:
  Vector6d vector() {
    return Vector6d::NullaryExpr(
        [&] { return std::sqrt(12.0) * (static_cast<double>(bits_() >> 11) * 0x1p-53 - 0.5); });
  }
  Matrix6d information(double scale) {
    Matrix6d root = Matrix6d::NullaryExpr([&] { return vector()[0]; });
    return scale * (root * root.transpose() + Matrix6d::Identity());
  }

 private:
  std::mt19937_64 bits_{3};
};

Vector6d moving_rate(int frame) {
  Vector6d rate;
  rate << 0.3 * std::sin(0.21 * frame), 0.25 * std::cos(0.17 * frame), 0.2 * std::sin(0.13 * frame),
      0.4 * std::cos(0.11 * frame), 0.3 * std::sin(0.19 * frame), 0.2 * std::cos(0.23 * frame);
  return rate;
}

/// Frames whose surfaces are seen `true_s` later than stamped, corrected for what is believed, and
/// fused with the picture: at their balance both pull, against each other.
void feed(DelayEstimator& estimator, double true_s, int frames, double noise, double speed = 1) {
  RandomSums random;
  for (int i = 0; i < frames; ++i) {
    const Vector6d rate = speed * moving_rate(i);
    const Matrix6d H_geometry = random.information(1e6), H_vision = random.information(2e6);
    const Vector6d geometry_optimum =
        (true_s - estimator.delay_s()) * rate + noise * random.vector();
    const Vector6d vision_optimum = noise * random.vector();
    const Matrix6d H = H_geometry + H_vision;
    const Vector6d balance =
        H.ldlt().solve(H_geometry * geometry_optimum + H_vision * vision_optimum);
    estimator.update(H_geometry, H_vision, H_vision * (balance - vision_optimum), rate);
  }
}

TEST(DelayEstimator, LearnsADelayOfEitherSign) {
  for (const double truth : {-0.0177, -0.004, 0.0, 0.009, 0.025}) {
    DelayEstimator estimator(DelayConfig{});
    EXPECT_EQ(estimator.delay_s(), 0);
    feed(estimator, truth, 300, 1e-3);
    EXPECT_NEAR(estimator.delay_s(), truth, 1e-3) << truth;
  }
}

TEST(DelayEstimator, NothingIsLearnedWithoutMotion) {
  DelayEstimator estimator(DelayConfig{});
  feed(estimator, 0.02, 300, 1e-3, 0);
  EXPECT_EQ(estimator.delay_s(), 0);
  feed(estimator, 0.02, 300, 1e-5, 1e-4);  // as good as none: the prior holds it
  EXPECT_LT(std::abs(estimator.delay_s()), 2e-3);
}

TEST(DelayEstimator, StaysWithinItsBounds) {
  const DelayConfig config;
  for (const double truth : {-0.2, 0.2}) {
    DelayEstimator estimator(config);
    feed(estimator, truth, 300, 1e-3);
    EXPECT_EQ(estimator.delay_s(), std::copysign(config.most_s, truth));
  }
}

TEST(DelayEstimator, FollowsADelayThatChanges) {
  DelayEstimator estimator(DelayConfig{});
  feed(estimator, 0.02, 300, 1e-3);
  feed(estimator, -0.01, 2000, 1e-3);
  EXPECT_NEAR(estimator.delay_s(), -0.01, 1e-3);
}

// A calibration has taken over what was learned: stamps mean something else.
TEST(DelayEstimator, ShiftLeavesWhatIsMeasuredWhereItWas) {
  DelayEstimator estimator(DelayConfig{});
  feed(estimator, -0.015, 300, 1e-3);
  const double before = estimator.delay_s();
  estimator.shift(-0.012, 0);
  EXPECT_NEAR(estimator.delay_s(), before + 0.012, 1e-4);
  feed(estimator, -0.003, 300, 1e-3);
  EXPECT_NEAR(estimator.delay_s(), -0.003, 1e-3);
}

// Frames that hardly move against each other seem to show a delay that nobody has.
TEST(DelayEstimator, WhatACalibrationKnowsIsNotLearnedOnTop) {
  DepthCalibration calibration;
  EXPECT_EQ(beside(DelayConfig{}, calibration).prior_sigma_s, DelayConfig{}.prior_sigma_s);
  calibration.delay_sigma_s = 0.05;
  EXPECT_EQ(beside(DelayConfig{}, calibration).prior_sigma_s, DelayConfig{}.prior_sigma_s);
  calibration.delay_sigma_s = 0.001;
  EXPECT_EQ(beside(DelayConfig{}, calibration).prior_sigma_s, 0.001);
  calibration.delay_sigma_s = 1e-9;
  EXPECT_GT(beside(DelayConfig{}, calibration).prior_sigma_s, 1e-4);

  DelayEstimator told(DelayConfig{}), untold(DelayConfig{});
  told.shift(0, 1e-3);
  feed(told, -0.01, 3, 1e-3, 0.05);
  feed(untold, -0.01, 3, 1e-3, 0.05);
  EXPECT_LT(std::abs(told.delay_s()), 0.5 * std::abs(untold.delay_s()));
}

TEST(DelayEstimator, LearnsNothingWhereItIsOffOrNumbersAreNone) {
  DelayConfig config;
  config.estimate = false;
  DelayEstimator off(config);
  feed(off, 0.02, 100, 1e-3);
  EXPECT_EQ(off.delay_s(), 0);

  DelayEstimator estimator(DelayConfig{});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  estimator.update(Matrix6d::Identity(), Matrix6d::Identity(), Vector6d::Constant(nan),
                   moving_rate(1));
  estimator.update(Matrix6d::Zero(), Matrix6d::Zero(), Vector6d::Ones(), moving_rate(1));
  EXPECT_EQ(estimator.delay_s(), 0);
}

// Where either half sees nothing along the way of the camera, there is nothing to compare.
TEST(DelayEstimator, AnAxisThatOneHalfDoesNotSeeSaysNothing) {
  DelayEstimator estimator(DelayConfig{});
  Vector6d rate = Vector6d::Zero();
  rate[3] = 0.5;
  Matrix6d blind = 1e5 * Matrix6d::Identity();
  blind(3, 3) = 0;
  for (int i = 0; i < 100; ++i) {
    estimator.update(blind, 1e5 * Matrix6d::Identity(), Vector6d::Zero(), rate);
  }
  EXPECT_EQ(estimator.delay_s(), 0);
}

}  // namespace
}  // namespace sgs::tracker
