// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/exposure_curve.h"

#include <gtest/gtest.h>

namespace sgs::refine {
namespace {

TEST(ExposureCurve, LiesBetweenItsNeighboursAndIsFlatBeyond) {
  const ExposureCurve curve({{1, {1, 2, 1}}, {3, {2, 1, 1}}});
  EXPECT_FLOAT_EQ(curve.at(1.5)[0], 1.25f);
  EXPECT_FLOAT_EQ(curve.at(1.5)[1], 1.75f);
  EXPECT_FLOAT_EQ(curve.at(3)[0], 2);
  EXPECT_FLOAT_EQ(curve.at(0)[1], 2);
  EXPECT_FLOAT_EQ(curve.at(9)[0], 2);
}

TEST(ExposureCurve, IsOneWhereNothingIsKnown) {
  EXPECT_TRUE(ExposureCurve().empty());
  EXPECT_EQ(ExposureCurve().at(1), (std::array<float, 3>{1, 1, 1}));
}

}  // namespace
}  // namespace sgs::refine
