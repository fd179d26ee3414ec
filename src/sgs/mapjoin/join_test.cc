// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/join.h"

#include <gtest/gtest.h>

#include "sgs/mapjoin/test_walls.h"

namespace sgs::mapjoin {
namespace {

constexpr int kViews = 9;

Outcome joined(Part& base, const Part& other, int threads) {
  ThreadPool pool(threads);
  return join(base, other, pool);
}

TEST(Join, FindsWhereTheOtherWorldLies) {
  const Part first = walk_along_wall("first", 0, kViews, SE3{});
  const Part second = walk_along_wall("second", 0.7, kViews, another_world());
  Part base = first;
  const Outcome outcome = joined(base, second, 1);
  ASSERT_TRUE(outcome.joined) << outcome.sentence();
  const SE3 error = outcome.T_base_other * another_world();
  EXPECT_LT(error.t.norm(), 0.03) << outcome.sentence();
  EXPECT_LT(error.angle(), 0.01);
  ASSERT_EQ(base.views(), 2u * kViews);
  EXPECT_EQ(base.T_world_camera[0].t, first.T_world_camera[0].t);
  for (std::size_t i = 0; i < kViews; ++i) {
    const SE3 T = another_world().inverse() * second.T_world_camera[i];
    EXPECT_LT((base.T_world_camera[kViews + i].t - T.t).norm(), 0.02) << i;
    EXPECT_EQ(base.view(kViews + i).T_world_camera.t, base.T_world_camera[kViews + i].t);
  }
  // Sessions are numbered on, and Gaussians lie on the wall again.
  ASSERT_EQ(base.sessions.size(), 2u);
  EXPECT_EQ(base.sessions[1].name, "second");
  EXPECT_EQ(base.graph.session.back(), 1);
  EXPECT_EQ(base.gaussians.born_in.back(), 1);
  for (const map::Gaussian& g : base.gaussians.splats.gaussians) {
    EXPECT_NEAR(g.mean[2], alignment::kWallDistance_m, 0.03);
  }
  // Edges say what poses say.
  for (const graph::Edge& e : base.graph.edges) {
    EXPECT_LT(graph::chi2(e, base.T_world_camera[static_cast<std::size_t>(e.from)],
                          base.T_world_camera[static_cast<std::size_t>(e.to)]),
              1e-6);
  }
}

TEST(Join, ThreadsChangeNothing) {
  const Part second = walk_along_wall("second", 0.7, kViews, another_world());
  Part one = walk_along_wall("first", 0, kViews, SE3{}), three = one;
  joined(one, second, 1);
  joined(three, second, 3);
  ASSERT_EQ(one.views(), 2u * kViews);
  ASSERT_EQ(one.views(), three.views());
  for (std::size_t i = 0; i < one.views(); ++i) {
    EXPECT_EQ(one.T_world_camera[i].t, three.T_world_camera[i].t);
    EXPECT_EQ(one.T_world_camera[i].R, three.T_world_camera[i].R);
  }
}

TEST(Join, AnotherWallIsNeverTakenForThisOne) {
  Part base = walk_along_wall("first", 0, kViews, SE3{});
  const Part other = walk_along_wall("elsewhere", 30, kViews, another_world());
  const Outcome outcome = joined(base, other, 1);
  EXPECT_FALSE(outcome.joined);
  EXPECT_EQ(base.views(), static_cast<std::size_t>(kViews));
  EXPECT_EQ(base.sessions.size(), 1u);
  EXPECT_NE(outcome.sentence().find("3 are needed"), std::string::npos) << outcome.sentence();
}

// Two views that are the same place are too few, however well they fit.
TEST(Join, TwoViewsInCommonAreTooFew) {
  Part base = walk_along_wall("first", 0, kViews, SE3{});
  const Part other = walk_along_wall("second", 0.3, 2, another_world());
  EXPECT_FALSE(joined(base, other, 1).joined);
}

}  // namespace
}  // namespace sgs::mapjoin
