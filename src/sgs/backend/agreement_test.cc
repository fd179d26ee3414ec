// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/agreement.h"

#include <gtest/gtest.h>

namespace sgs::backend {
namespace {

/// A half of a recording that knows everything well.
FreeEstimate a_half() {
  FreeEstimate e;
  e.mean_per_m = 0.002;
  e.mean_sigma_per_m = 3e-4;
  e.area.assign(4, 0.25);
  e.shape_per_m = {0.001, -0.001, 0.001, -0.001};
  e.shape_sigma_per_m.assign(4, 2e-4);
  e.shift_px = {1, 2};
  e.shift_covariance = 0.01 * Eigen::Matrix2d::Identity();
  e.delay_s = -0.017;
  e.delay_sigma_s = 3e-4;
  return e;
}

TEST(Agreement, WhatIsTheSameAgrees) {
  const Disagreement d = compare(a_half(), a_half());
  EXPECT_FALSE(contradicted(d).any());
  EXPECT_EQ(d.shape.half, 0);
}

TEST(Agreement, EachPartIsJudgedOnItsOwn) {
  FreeEstimate other = a_half();
  other.mean_per_m += 0.002;
  EXPECT_EQ(contradicted(compare(a_half(), other)).names(), "mean offset");
  other = a_half();
  other.shape_per_m = {-0.001, 0.001, -0.001, 0.001};
  EXPECT_EQ(contradicted(compare(a_half(), other)).names(), "shape");
  other = a_half();
  other.shift_px.y() -= 2;
  EXPECT_EQ(contradicted(compare(a_half(), other)).names(), "shift");
  other = a_half();
  other.delay_s = -0.009;
  other.shift_px.x() += 2;
  EXPECT_EQ(contradicted(compare(a_half(), other)).names(), "shift, delay");
}

TEST(Agreement, WhoIsNotSureContradictsNobody) {
  FreeEstimate other = a_half();
  other.delay_s = 0;
  other.delay_sigma_s = 0.01;
  EXPECT_FALSE(contradicted(compare(a_half(), other)).any());
}

TEST(Agreement, WhatIsLargeBesideTheDifferenceStands) {
  FreeEstimate other = a_half();
  other.delay_s = -0.0152;
  const Disagreement d = compare(a_half(), other);
  EXPECT_GT(d.delay.sigmas, 4);
  EXPECT_FALSE(contradicted(d).any());
  EXPECT_NEAR(d.delay.half, 9e-4, 1e-12);
}

TEST(Agreement, AShiftCountsAlongTheAxisThatIsKnown) {
  FreeEstimate a = a_half(), b = a_half();
  a.shift_covariance << 4, 0, 0, 1e-4;
  b.shift_covariance = a.shift_covariance;
  b.shift_px.x() += 2;
  EXPECT_FALSE(contradicted(compare(a, b)).any());
  b.shift_px.y() -= 2;
  EXPECT_TRUE(contradicted(compare(a, b)).shift);
}

TEST(Agreement, WhatIsOfNoConsequenceIsNoContradiction) {
  FreeEstimate a = a_half();
  a.delay_sigma_s = 1e-6;
  a.shift_covariance *= 1e-4;
  FreeEstimate b = a;
  b.delay_s += 4e-4;
  b.shift_px.x() += 0.09;
  EXPECT_FALSE(contradicted(compare(a, b)).any());
}

TEST(Agreement, HalfOfTheDifferenceIsTold) {
  FreeEstimate other = a_half();
  other.delay_s = -0.015;
  other.shift_px = {1, 4};
  other.shape_per_m[2] += 4e-4;
  const Disagreement d = compare(a_half(), other);
  EXPECT_NEAR(d.delay.half, 0.001, 1e-12);
  EXPECT_NEAR(d.half_shift_px.y(), 1, 1e-12);
  EXPECT_NEAR(d.shape.half, 1e-4, 1e-12);
  EXPECT_NEAR(d.half_shape_per_m[2], 2e-4, 1e-12);
  EXPECT_NEAR(d.mean.half, 0, 1e-12);
}

TEST(Agreement, ACalibrationMustFitBetterThanNone) {
  const Fit unused{1.0, 2.0, 1000, 1200};
  EXPECT_TRUE(fits_better({0.9, 1.0, 1000, 1200}, unused));
  EXPECT_TRUE(fits_better({1.01, 1.0, 1000, 1200}, unused));
  EXPECT_FALSE(fits_better(unused, unused)) << "nothing is won";
  EXPECT_FALSE(fits_better({1.1, 1.0, 1000, 1200}, unused)) << "pictures fit worse";
  EXPECT_FALSE(fits_better({0.9, 2.1, 1000, 1200}, unused)) << "depths fit worse";
  EXPECT_FALSE(fits_better({0.9, 1.0, 900, 1200}, unused)) << "places are lost";
  EXPECT_FALSE(fits_better({0.9, 1.0, 1000, 1200}, Fit{})) << "nothing to compare with";
}

TEST(Agreement, FitsOfSeveralStretchesCountByTheirResiduals) {
  const Fit sum = Fit{1, 2, 100, 300} + Fit{4, 6, 200, 100};
  EXPECT_NEAR(sum.grey, 3, 1e-12);
  EXPECT_NEAR(sum.depth, 3, 1e-12);
  EXPECT_EQ(sum.grey_residuals, 300);
  EXPECT_EQ(sum.depth_residuals, 400);
}

TEST(Agreement, Parts) {
  const CalibrationParts a{.shift = true, .delay = true}, b{.mean = true, .delay = true};
  EXPECT_EQ((a | b).names(), "mean offset, shift, delay");
  EXPECT_EQ((a & b).names(), "delay");
  EXPECT_EQ(without(a, b).names(), "shift");
  EXPECT_FALSE(CalibrationParts{}.any());
}

}  // namespace
}  // namespace sgs::backend
