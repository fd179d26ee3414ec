// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/cell_mask.h"

#include <gtest/gtest.h>

namespace sgs::registration {
namespace {

TEST(CellMask, HoldsNowhereByDefault) {
  const CellMask none;
  EXPECT_FALSE(none.any());
  EXPECT_FALSE(none.at(0, 0));
  EXPECT_FALSE(CellMask(8, 2, {0, 0, 0, 0}).any());
}

TEST(CellMask, TellsTheCellAroundAPixelAndReachesToTheRim) {
  const CellMask mask(8, 2, {0, 1, 0, 1});
  EXPECT_TRUE(mask.any());
  EXPECT_EQ(mask.rows(), 2);
  EXPECT_FALSE(mask.at(7, 0));
  EXPECT_TRUE(mask.at(8, 0));
  EXPECT_TRUE(mask.at(19, 17));  // beyond the last whole cell
  EXPECT_FALSE(mask.at(0, 17));
}

TEST(CellMask, UnitedHoldsWhereEitherDoes) {
  const CellMask fine(4, 4, {1, 0, 0, 0, 0, 0, 0, 0}), coarse(8, 2, {0, 1});
  const CellMask both = fine.united(coarse);
  EXPECT_EQ(both.cells(), (std::vector<std::uint8_t>{1, 0, 1, 1, 0, 0, 1, 1}));
  EXPECT_EQ(fine.united({}).cells(), fine.cells());
  EXPECT_EQ(CellMask().united(coarse).cells(), coarse.cells());
  EXPECT_FALSE(CellMask().united({}).any());
}

}  // namespace
}  // namespace sgs::registration
