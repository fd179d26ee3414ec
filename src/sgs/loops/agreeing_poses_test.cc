// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/agreeing_poses.h"

#include <gtest/gtest.h>

#include "sgs/alignment/test_textured_wall.h"

namespace sgs::loops {
namespace {

/// Views side by side before the papered wall, each said to be some millimetres from where it is.
class AgreeingPosesTest : public testing::Test {
 protected:
  AgreeingPosesTest() {
    for (int i = 0; i < 6; ++i) {
      const double side = i % 2 == 0 ? 1 : -1;
      true_.push_back({so3_exp({0.02, -0.01, 0.01}), {0.08 * i, 0.02 * side, 0}});
      alignment::KnownView view;
      view.timestamp_s = i;
      view.T_world_camera = true_.back() * SE3(so3_exp({0.003 * side, -0.002, 0.002 * side}),
                                               {0.004 * side, 0.003 * (i % 3 - 1), 0.005 * side});
      view.frame = alignment::see_wall(true_.back(), i);
      views_.push_back(std::move(view));
    }
  }
  std::vector<SE3> agreeing(int threads) const {
    ThreadPool pool(threads);
    const auto view = [this](std::size_t number) { return views_[number]; };
    return agreeing_poses({views_.size(), view}, LoopConfig{}, alignment::AlignerConfig{}, pool);
  }
  std::vector<SE3> said() const {
    std::vector<SE3> out;
    for (const auto& view : views_) out.push_back(view.T_world_camera);
    return out;
  }
  /// Mean distance of each view from where the one before it has it.
  double disagreement_m(const std::vector<SE3>& poses) const {
    double sum = 0;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      sum += ((true_[i - 1].inverse() * true_[i]).inverse() * (poses[i - 1].inverse() * poses[i]))
                 .t.norm();
    }
    return sum / static_cast<double>(poses.size() - 1);
  }

  std::vector<SE3> true_;
  std::vector<alignment::KnownView> views_;
};

TEST_F(AgreeingPosesTest, NeighboursSeeTheSameThingsInTheSamePlace) {
  EXPECT_GT(disagreement_m(said()), 0.01);
  const auto poses = agreeing(1);
  EXPECT_LT(disagreement_m(poses), 0.003);
  // Together they stay where they were held to be.
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((poses[i].t - true_[i].t).norm(), 0.01) << i;
  }
}

TEST_F(AgreeingPosesTest, ThreadsChangeNothing) {
  const auto one = agreeing(1), three = agreeing(3);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].t, three[i].t);
    EXPECT_EQ(one[i].R, three[i].R);
  }
}

// What no other view sees, and a view that shows no depth, stay where they are.
TEST_F(AgreeingPosesTest, AViewWithoutNeighboursIsLeftAlone) {
  views_.resize(1);
  EXPECT_LT((agreeing(1)[0].inverse() * views_[0].T_world_camera).log().norm(), 1e-9);
  views_[0].frame.depth.fill(0);
  EXPECT_LT((agreeing(1)[0].inverse() * views_[0].T_world_camera).log().norm(), 1e-9);
  views_.clear();
  EXPECT_TRUE(agreeing(1).empty());
}

}  // namespace
}  // namespace sgs::loops
