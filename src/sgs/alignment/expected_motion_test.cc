// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/expected_motion.h"

#include <gtest/gtest.h>

namespace sgs::alignment {
namespace {

SE3 off_by(double turn_rad, double move_m) {
  Vector6d x = Vector6d::Zero();
  x(1) = turn_rad;
  x(3) = move_m;
  return SE3::exp(x);
}

// Poses that are off what was expected by so much times -1, 0, 1 or 2.
ExpectedMotion after(int frames, double turn_rad, double move_m) {
  ExpectedMotion motion;
  for (int i = 0; i < frames; ++i) {
    const double k = i % 4 - 1;
    motion.expect(SE3{});
    motion.learn(off_by(k * turn_rad, k * move_m));
  }
  motion.expect(SE3{});
  return motion;
}

TEST(ExpectedMotion, SaysNothingBeforeItHasSeenSome) {
  EXPECT_FALSE(after(3, 0.01, 0.01).prior({}));
  EXPECT_TRUE(after(20, 0.01, 0.01).prior({}));
  EXPECT_FALSE(after(20, 0, 0).prior({}));  // nothing has ever moved
}

TEST(ExpectedMotion, IsAsSureAsItWasRight) {
  const auto good = after(40, 0.001, 0.002).prior({}), bad = after(40, 0.01, 0.02).prior({});
  ASSERT_TRUE(good && bad);
  EXPECT_NEAR(good->weight(1, 1) / bad->weight(1, 1), 100, 1);
  EXPECT_NEAR(good->weight(3, 3) / bad->weight(3, 3), 100, 1);
  EXPECT_NEAR(good->weight(1, 1) / good->weight(3, 3), 4, 0.1);
}

TEST(ExpectedMotion, WhoLeapsIsHeldBackLessTheFartherTheyAre) {
  const ExpectedMotion motion = after(40, 0.001, 0.002);
  const auto pull = [&](double move_m) {
    return motion.prior(off_by(0, move_m))->weight(3, 3) * move_m;
  };
  EXPECT_GT(pull(0.004), pull(0.001));
  EXPECT_LT(pull(0.5), pull(0.05));
  EXPECT_LT(pull(0.05), pull(0.004));
}

TEST(ExpectedMotion, OneLeapDoesNotChangeWhatIsUsual) {
  ExpectedMotion motion = after(40, 0.001, 0.002);
  const double before = motion.prior({})->weight(3, 3);
  motion.learn(off_by(0.5, 1));
  EXPECT_NEAR(motion.prior({})->weight(3, 3), before, 0.1 * before);
}

TEST(ExpectedMotion, NobodyKnowsWhereACameraWillBeThatWasFoundAgain) {
  ExpectedMotion motion = after(6, 0.001, 0.002);
  const Matrix6d before = motion.prior({})->weight;
  motion.expect({});
  EXPECT_FALSE(motion.prior({}));
  for (int i = 0; i < 60; ++i) motion.learn(off_by(0.5, 1));  // nothing was expected of them
  motion.expect(SE3{});
  ASSERT_TRUE(motion.prior({}));
  EXPECT_EQ(motion.prior({})->weight, before);
}

}  // namespace
}  // namespace sgs::alignment
