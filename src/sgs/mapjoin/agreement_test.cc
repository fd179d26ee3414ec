// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/agreement.h"

#include <gtest/gtest.h>

namespace sgs::mapjoin {
namespace {

/// Views of two maps, one metre from each other, and what is said of how they hang together.
class AgreementTest : public testing::Test {
 protected:
  AgreementTest() {
    for (int i = 0; i < 6; ++i) poses_.push_back({so3_exp({0, 0.1 * i, 0}), {1.0 * i, 0, 0}});
    for (int i = 0; i < 6; ++i) {
      poses_.push_back(T_base_other_.inverse() * poses_[static_cast<std::size_t>(i)]);
    }
  }
  /// View i of the one is the same place as view i of the other, but for `error`.
  graph::Edge tie(int i, const SE3& error) const {
    return {i, 6 + i, error, 1e5 * Matrix6d::Identity(), true};
  }

  const SE3 T_base_other_{so3_exp({0.5, 0.2, -1}), {4, 5, 6}};
  std::vector<SE3> poses_;
};

TEST_F(AgreementTest, TheLargestSetThatAgreesIsBelieved) {
  std::vector<graph::Edge> ties;
  for (int i = 0; i < 4; ++i) ties.push_back(tie(i, {so3_exp({0, 0, 0}), {0.002 * i, 0, 0}}));
  ties.push_back(tie(4, {so3_exp({0, 1, 0}), {0.5, 0, 0}}));
  ties.push_back(tie(5, {so3_exp({0, 0, 1}), {0, -0.5, 0}}));
  const Agreement a = agreement_of(ties, poses_, {});
  ASSERT_EQ(a.ties.size(), 4u);
  EXPECT_EQ(a.rival, 1u);
  EXPECT_LT((a.T_base_other.inverse() * T_base_other_).log().norm(), 0.02);
}

TEST_F(AgreementTest, TwoPlacesThatAreAsLikelyAreTold) {
  const SE3 elsewhere(so3_exp({0, 0, 0}), {0, 2, 0});
  std::vector<graph::Edge> ties;
  for (int i = 0; i < 3; ++i) ties.push_back(tie(i, SE3{}));
  // The same shift of the other world, seen from views that are turned.
  for (int i = 3; i < 6; ++i) {
    const SE3& T = poses_[static_cast<std::size_t>(i)];
    ties.push_back(tie(i, T.inverse() * elsewhere * T));
  }
  const Agreement a = agreement_of(ties, poses_, {});
  EXPECT_EQ(a.ties.size(), 3u);
  EXPECT_EQ(a.rival, 3u);
}

TEST_F(AgreementTest, NothingAgreesWithNothing) {
  const Agreement a = agreement_of({}, poses_, {});
  EXPECT_TRUE(a.ties.empty());
  EXPECT_EQ(a.rival, 0u);
}

}  // namespace
}  // namespace sgs::mapjoin
