// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/motion_model.h"

#include <gtest/gtest.h>

namespace sgs::tracker {
namespace {

constexpr double kFrame_s = 1.0 / 30;

Vector6d steady_twist() {
  Vector6d rate;
  rate << 0.2, -0.3, 0.1, 0.4, 0.2, -0.3;
  return rate;
}

/// Goes on from `i` frames at the steady twist.
void follow(MotionModel& model, int first, int last) {
  for (int i = first; i < last; ++i) {
    model.accept(SE3::exp(i * kFrame_s * steady_twist()), i * kFrame_s);
  }
}

TEST(MotionModel, SteadyRateIsThatOfASteadyMotion) {
  MotionModel model(MotionConfig{}, SE3{});
  EXPECT_TRUE(model.steady_rate().isZero(0));
  follow(model, 0, 1);
  EXPECT_TRUE(model.steady_rate().isZero(0));
  follow(model, 1, 8);
  EXPECT_LT((model.steady_rate() - steady_twist()).norm(), 1e-9);
}

// Points are corrected by it: a pose that is wrong once must not swing them as far as itself.
TEST(MotionModel, SteadyRateFollowsOneFrameByHalfOnly) {
  MotionModel model(MotionConfig{}, SE3{});
  follow(model, 0, 8);
  const SE3 off = SE3::exp(8 * kFrame_s * steady_twist()) *
                  SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.02, 0, 0));
  const Vector6d change = model.rate_to(off, 8 * kFrame_s) - model.steady_rate();
  const Vector6d before = model.steady_rate();
  model.accept(off, 8 * kFrame_s);
  EXPECT_LT((model.steady_rate() - before - 0.5 * change).norm(), 1e-9);
}

TEST(MotionModel, SteadyRateIsForgottenWhereFramesWereLost) {
  MotionModel model(MotionConfig{}, SE3{});
  follow(model, 0, 8);
  model.miss();
  follow(model, 9, 10);
  EXPECT_TRUE(model.steady_rate().isZero(0));
  follow(model, 10, 12);
  EXPECT_FALSE(model.steady_rate().isZero(0));
  model.hold();
  EXPECT_TRUE(model.steady_rate().isZero(0));
  follow(model, 12, 16);
  model.jump_to(SE3{});
  EXPECT_TRUE(model.steady_rate().isZero(0));
}

}  // namespace
}  // namespace sgs::tracker
