// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/loop_verifier.h"

#include <gtest/gtest.h>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/registration/view_distance.h"

namespace sgs::loops {
namespace {

SE3 before_wall(double x_m, double distance_m) {
  return {so3_exp({0.02, -0.01, 0.01}), {x_m, 0, alignment::kWallDistance_m - distance_m}};
}

/// Three nodes side by side before the papered wall, 1.5 m away from it, and where a fourth is.
class LoopVerifierTest : public testing::Test {
 protected:
  LoopVerifierTest() {
    for (const double x : {-0.15, 0.0, 0.15}) add(before_wall(x, 1.5), before_wall(x, 1.5));
  }
  /// `T_seen`: where its picture is taken.
  void add(const SE3& T_said, const SE3& T_seen) {
    const RgbdFrame frame = alignment::see_wall(T_seen, pose_graph_.size());
    Node node;
    node.frame = pose_graph_.size();
    node.timestamp_s = 10 * pose_graph_.size();
    node.mean_depth_m = registration::mean_depth(frame.depth, 10);
    node.view = std::make_shared<const history::StoredView>(frame);
    revision_.path.append({node.frame, node.timestamp_s, T_said});
    pose_graph_.follow(revision_);
    pose_graph_.add(std::move(node), 1e-4 * Matrix6d::Identity());
  }
  /// Of the newest node to the one in the middle, which is expected where the nodes say.
  std::optional<graph::Edge> verify() const {
    const LoopVerifier verifier(LoopConfig{}, PairConfig{});
    const int newest = pose_graph_.size() - 1;
    return verifier.verify(pose_graph_, 1, newest,
                           pose_graph_.pose(1).inverse() * pose_graph_.pose(newest));
  }

  history::Revision revision_;
  PoseGraph pose_graph_;
};

// A quarter of what the older node saw fills the newer one's image.
TEST_F(LoopVerifierTest, APlaceIsKnownAgainFromHalfTheDistance) {
  const SE3 T_true = before_wall(0.03, 0.75);
  add(T_true * SE3(so3_exp({0.01, 0, 0.01}), {0.02, -0.01, 0.02}), T_true);
  const auto loop = verify();
  ASSERT_TRUE(loop);
  const SE3 off = (before_wall(0, 1.5).inverse() * T_true).inverse() * loop->T_from_to;
  EXPECT_LT(off.t.norm(), 0.005);
  EXPECT_LT(off.angle(), 0.005);
}

// As flat and as far away, with another picture: surfaces alone join nothing.
TEST_F(LoopVerifierTest, AnotherWallIsNotTakenForThisOne) {
  for (const double distance_m : {1.5, 0.75}) {
    add(before_wall(0.03, distance_m), before_wall(50.03, distance_m));
    EXPECT_FALSE(verify()) << distance_m;
  }
}

}  // namespace
}  // namespace sgs::loops
