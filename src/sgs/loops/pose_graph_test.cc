// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sgs/loops/drift.h"

namespace sgs::loops {
namespace {

const PinholeCamera kCamera{64, 48, 60, 60, 31.5, 23.5};

SE3 at(double x) { return {Eigen::Matrix3d::Identity(), {x, 0, 0}}; }

Node node(int k) {
  Node n;
  n.frame = k;
  n.timestamp_s = k;
  n.mean_depth_m = 2;
  return n;
}

/// A pose graph that is told where each of its nodes is.
struct Walk : PoseGraph {
  void add(Node node, const SE3& T, const Matrix6d& covariance) {
    now.path.append({node.frame, node.timestamp_s, T});
    follow(now);
    PoseGraph::add(std::move(node), covariance);
  }
  history::Revision now;
};

TEST(EdgeInformation, SaysNothingOfWhatWasNotSeenAndNeverMoreThanItsFloor) {
  DriftConfig config;
  config.information_scale = 0.1;
  config.floor_m = 0.004;
  Matrix6d H = Matrix6d::Identity() * 1e12;
  H(3, 3) = 1e3;  // a slide that hardly shows
  const Matrix6d information = edge_information(H, 2, 2e4, config);
  EXPECT_EQ(graph::rank(information), 5);
  EXPECT_EQ(information(3, 3), 0);
  EXPECT_NEAR(information(4, 4), 1 / (0.004 * 0.004), 1e-3 / (0.004 * 0.004));
  // A turn moves what is 2 m away twice as far as its angle says.
  EXPECT_NEAR(information(0, 0), 4 * information(4, 4), 1e-3 * information(0, 0));
}

TEST(MotionCovariance, GrowsWithTheWayAndWithTheTimeLost) {
  const DriftConfig config;
  const Matrix6d H = Matrix6d::Identity() * 1e9;
  const auto of = [&](double path_m, double gap_s) {
    return motion_covariance(H, 2, path_m, gap_s, config).trace();
  };
  EXPECT_LT(of(0.1, 0), of(0.5, 0));
  EXPECT_GT(of(0.1, 1), 1);
  // Twice the way, twice the variance.
  EXPECT_NEAR(of(2, 0) - of(1, 0), of(1, 0) - of(0, 0), 1e-12);
  EXPECT_TRUE(motion_covariance(Matrix6d::Zero(), 2, 0, 0, config).allFinite());
}

TEST(PoseGraph, KnowsTheWayThroughALoopToBeSurer) {
  Walk s;
  const Matrix6d step = Matrix6d::Identity() * 1e-4;
  for (int k = 0; k < 20; ++k) s.add(node(k), at(0.1 * k), step);
  const double open = s.relative_to(19)[0].covariance.trace();
  EXPECT_NEAR(s.tracked(0, 19).covariance.trace() / open, 1, 1e-6);
  s.add_loop({1, 18, at(1.7), Matrix6d::Identity() * 1e6, true});
  const auto relative = s.relative_to(19);
  EXPECT_LT(relative[0].covariance.trace(), 0.2 * open);
  EXPECT_NEAR(relative[0].T.t.x(), 1.9, 1e-9);
  EXPECT_NEAR(relative[10].covariance.trace(), s.tracked(10, 19).covariance.trace(), 1e-3);
}

TEST(PoseGraph, NodesThatAreOutOfSightAreLeft) {
  Walk s;
  const Matrix6d step = Matrix6d::Identity() * 1e-4;
  s.add(node(0), at(0), step);
  s.note_left(kCamera, 0.8);
  EXPECT_FALSE(s.node(0).left);
  s.add(node(1), at(5), step);
  s.note_left(kCamera, 0.8);
  EXPECT_TRUE(s.node(0).left);
  s.add(node(2), at(0), step);
  s.note_left(kCamera, 0.8);
  EXPECT_TRUE(s.node(0).left) << "it stays a place that was left";
  EXPECT_FALSE(s.node(2).left);
}

TEST(PoseGraph, ALoopSpreadsItsErrorOverTheWay) {
  Walk s;
  for (int k = 0; k < 11; ++k) s.add(node(k), at(0.1 * k), Matrix6d::Identity() * 1e-4);
  s.add_loop({0, 10, at(1.1), Matrix6d::Identity() * 1e10, true});
  const auto solution = s.solve();
  EXPECT_EQ(solution.weights.back(), 1);
  EXPECT_NEAR(solution.T_world_node[10].t.x(), 1.1, 1e-4);
  EXPECT_NEAR(solution.T_world_node[5].t.x(), 0.55, 1e-4);
}

// To and fro past the same eight places: what is kept of them is what was seen first.
TEST(PoseGraph, ViewsOfPlacesThatAreKnownAreForgotten) {
  constexpr int kPlaces = 8, kRounds = 6;
  RgbdFrame frame;
  frame.camera = kCamera;
  frame.color = ColorImage(kCamera.width, kCamera.height);
  frame.depth = DepthImage(kCamera.width, kCamera.height, 2.0f);
  const auto view = std::make_shared<const history::StoredView>(frame);
  Walk s;
  for (int k = 0; k < kPlaces * kRounds; ++k) {
    const int phase = k % (2 * kPlaces), place = phase < kPlaces ? phase : 2 * kPlaces - 1 - phase;
    Node n = node(k);
    n.view = view;
    s.add(std::move(n), at(0.5 * place + 0.001 * k), Matrix6d::Identity() * 1e-4);
    s.note_left(kCamera, 0.3);
    s.bound_views(kCamera, 12);
    std::size_t views = 0;
    for (int i = 0; i < s.size(); ++i) views += s.node(i).view ? 1 : 0;
    EXPECT_LE(views, 12u);
    EXPECT_TRUE(s.node(k).view) << "the newest one is asked for";
  }
  for (int k = 0; k < kPlaces; ++k) EXPECT_TRUE(s.node(k).view) << k;
}

// A way of thirty nodes in a bow, with a loop: those that nothing needs can go, and the others end
// where they would have ended.
TEST(PoseGraph, WaysAreJoinedWithoutChangingWhatTheySay) {
  RgbdFrame frame;
  frame.camera = kCamera;
  frame.color = ColorImage(kCamera.width, kCamera.height);
  frame.depth = DepthImage(kCamera.width, kCamera.height, 2.0f);
  const auto build = [&frame] {
    Walk s;
    for (int k = 0; k < 30; ++k) {
      Node n = node(k);
      if (k % 10 == 5) n.view = std::make_shared<const history::StoredView>(frame);
      s.add(std::move(n), SE3(so3_exp({0, 0, 0.02 * k}), {0.1 * k, 0.003 * k * k, 0}),
            Matrix6d::Identity() * 1e-4 * (1 + k % 3));
    }
    const SE3 T = s.pose(2).inverse() * s.pose(27);
    s.add_loop({2, 27, T * at(0.05), Matrix6d::Identity() * 1e6, true});
    return s;
  };
  const Walk all = build();
  Walk few = build();
  std::vector<graph::Edge> pending = {{4, 28, at(2.4), Matrix6d::Identity(), true}};
  few.join_odometry_edges(pending);
  // First, last, the ends of both edges, and three views.
  ASSERT_EQ(few.size(), 9);
  EXPECT_EQ(few.nodes_added(), 30);
  const auto index_of = [&](int number) {
    for (int k = 0; k < few.size(); ++k) {
      if (few.node(k).number == number) return k;
    }
    return -1;
  };
  EXPECT_EQ(pending[0].from, index_of(4));
  EXPECT_EQ(pending[0].to, index_of(28));
  EXPECT_EQ(few.loops()[0].from, index_of(2));
  EXPECT_EQ(few.loops()[0].to, index_of(27));
  const auto whole = all.tracked(5, 25), joined = few.tracked(index_of(5), index_of(25));
  EXPECT_LT((whole.T.t - joined.T.t).norm(), 1e-12);
  EXPECT_LT((whole.covariance - joined.covariance).norm(), 1e-9 * whole.covariance.norm());
  const auto a = all.solve(), b = few.solve();
  for (int k = 0; k < few.size(); ++k) {
    const SE3& expected = a.T_world_node[static_cast<std::size_t>(few.node(k).number)];
    const SE3& found = b.T_world_node[static_cast<std::size_t>(k)];
    EXPECT_LT((expected.t - found.t).norm(), 1e-3) << few.node(k).number;
  }
  EXPECT_EQ(b.weights.back(), 1);
  few.join_odometry_edges(pending);
  EXPECT_EQ(few.size(), 9) << "what is left is needed";
}

// Forty rounds of a circle whose way has drifted, each tied to the last one at every place.
TEST(PoseGraph, FewerLoopsHoldWhatTheyHaveFound) {
  Walk s;
  constexpr int kPlaces = 10, kRounds = 40;
  for (int k = 0; k < kPlaces * kRounds; ++k) {
    const double angle = 0.2 * std::numbers::pi * k;
    s.add(node(k), SE3(so3_exp({0, 0, angle}), {std::cos(angle), std::sin(angle), 1e-3 * k}),
          Matrix6d::Identity() * 1e-4);
    if (k >= kPlaces) s.add_loop({k - kPlaces, k, SE3(), Matrix6d::Identity() * 1e5, true});
  }
  const auto all = s.solve();
  s.thin_loops(1000);
  EXPECT_EQ(s.loops().size(), 390u);
  s.thin_loops(300);
  EXPECT_EQ(s.loops().size(), 244u);
  EXPECT_EQ(s.loops().back().to, 399);
  std::vector<graph::Edge> none;
  s.join_odometry_edges(none);
  EXPECT_LT(s.size(), 400);
  const auto fewer = s.solve();
  for (int k = 0; k < s.size(); ++k) {
    const SE3& expected = all.T_world_node[static_cast<std::size_t>(s.node(k).number)];
    EXPECT_LT((fewer.T_world_node[static_cast<std::size_t>(k)].t - expected.t).norm(), 0.01) << k;
  }
}

// Another calibration: loops and ways deviate from the new poses as they did from the old ones.
TEST(PoseGraph, WhatWasMeasuredFollowsAnotherDepth) {
  Walk s;
  for (int k = 0; k < 3; ++k) s.add(node(k), at(0.1 * k), Matrix6d::Identity() * 1e-4);
  s.add_loop({0, 2, at(0.25), Matrix6d::Identity() * 1e6, true});
  auto calibration = std::make_shared<DepthCalibration>();
  calibration->camera = kCamera;
  calibration->delay_s = 0.004;
  std::vector<MovedPose> twice;
  for (int k = 0; k < 3; ++k) twice.push_back({1.0 * k, at(0.1 * k), at(0.2 * k)});
  // Poses alone change nothing that was measured.
  s.follow(history::revised(s.now, {PoseCorrection(twice)}));
  EXPECT_NEAR(s.tracked(0, 2).T.t.x(), 0.2, 1e-12);
  EXPECT_NEAR(s.pose(2).t.x(), 0.4, 1e-12);
  s.follow(s.now);
  s.follow(history::revised(s.now, {PoseCorrection(twice), calibration}));
  EXPECT_NEAR(s.tracked(0, 2).T.t.x(), 0.4, 1e-12);
  EXPECT_NEAR(s.loops()[0].T_from_to.t.x(), 0.45, 1e-12);
  EXPECT_NEAR(s.node(1).motion.depth_delay_s, 0.004, 1e-12);
  EXPECT_NEAR(s.pose(2).t.x(), 0.4, 1e-12);
}

// Frames that were tracked anew: the camera moved otherwise, and what views say stays.
TEST(PoseGraph, OdometryFollowsFramesThatWereTrackedAnew) {
  Walk s;
  for (int k = 0; k < 3; ++k) s.add(node(k), at(0.1 * k), Matrix6d::Identity() * 1e-4);
  s.add_loop({0, 2, at(0.25), Matrix6d::Identity() * 1e6, true});
  s.follow(history::revised(
      s.now,
      {.poses = PoseCorrection({{0, at(0), at(0)}, {1, at(0.1), at(0.12)}, {2, at(0.2), at(0.2)}}),
       .tracked_anew = true}));
  EXPECT_NEAR(s.tracked(0, 1).T.t.x(), 0.12, 1e-12);
  EXPECT_NEAR(s.tracked(1, 2).T.t.x(), 0.08, 1e-12);
  EXPECT_NEAR(s.loops()[0].T_from_to.t.x(), 0.25, 1e-12);
}

}  // namespace
}  // namespace sgs::loops
