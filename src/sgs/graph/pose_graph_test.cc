// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/graph/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sgs/core/error.h"
#include "sgs/core/random.h"

namespace sgs::graph {
namespace {

// A walk in circles with noisy steps; node k stands where node k - kRound stood a round ago.
constexpr int kRound = 40, kNodes = 120;
constexpr double kNoise = 0.005;

Vector6d noise(SplitMix64& random, double sigma) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) {
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += random.uniform();
    xi[i] = sigma * sum;
  }
  return xi;
}

struct World {
  std::vector<SE3> truth, drifted;
  std::vector<Edge> edges;
};

World circles(std::uint64_t seed, int right_loops, int wrong_loops) {
  SplitMix64 random(seed);
  World w;
  for (int k = 0; k < kNodes; ++k) {
    const double a = 2 * M_PI * k / kRound;
    Vector6d turn = Vector6d::Zero();
    turn[2] = a;
    SE3 T = SE3::exp(turn);
    T.t = {3 * std::sin(a), -3 * std::cos(a), 0.1 * std::sin(0.3 * k)};
    w.truth.push_back(T);
  }
  const auto measured = [&](int a, int b) {
    return w.truth[static_cast<std::size_t>(a)].inverse() * w.truth[static_cast<std::size_t>(b)] *
           SE3::exp(noise(random, kNoise));
  };
  const Matrix6d information = Matrix6d::Identity() / (kNoise * kNoise);
  w.drifted.push_back(w.truth[0]);
  for (int k = 1; k < kNodes; ++k) {
    w.edges.push_back({k - 1, k, measured(k - 1, k), information, false});
    w.drifted.push_back(w.drifted.back() * w.edges.back().T_from_to);
  }
  for (int i = 0; i < right_loops; ++i) {
    const int b = kRound + static_cast<int>(random.below(kNodes - kRound));
    w.edges.push_back({b - kRound, b, measured(b - kRound, b), information, true});
  }
  for (int i = 0; i < wrong_loops; ++i) {
    const int b = kRound + static_cast<int>(random.below(kNodes - kRound));
    const int a = static_cast<int>(random.below(static_cast<std::size_t>(b - 20)));
    w.edges.push_back({a, b, SE3::exp(noise(random, 0.8)), information, true});
  }
  return w;
}

double error(const std::vector<SE3>& poses, const std::vector<SE3>& truth) {
  double sum = 0;
  for (std::size_t k = 0; k < poses.size(); ++k) sum += (poses[k].t - truth[k].t).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

TEST(PoseGraph, LoopsTakeTheDriftAway) {
  const World w = circles(1, 20, 0);
  const GraphSolution s = optimise(w.drifted, w.edges);
  EXPECT_LT(error(s.T_world_node, w.truth), 0.4 * error(w.drifted, w.truth));
  double chi2_sum = 0;
  for (const double c : s.chi2) chi2_sum += c;
  // Residuals less unknowns.
  const double freedom = 6.0 * (static_cast<double>(w.edges.size()) - (kNodes - 1));
  EXPECT_NEAR(chi2_sum / freedom, 1, 0.5);
}

TEST(PoseGraph, WrongLoopsAreLeftOutAndRightOnesAreNot) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    for (const int wrong : {1, 5, 20}) {
      const World w = circles(seed, 20, wrong);
      const GraphSolution s = optimise(w.drifted, w.edges);
      const std::size_t first_wrong = w.edges.size() - static_cast<std::size_t>(wrong);
      for (std::size_t k = first_wrong; k < w.edges.size(); ++k) {
        EXPECT_EQ(s.weights[k], 0) << seed << " " << wrong << " " << k;
      }
      int kept = 0;
      for (std::size_t k = kNodes - 1; k < first_wrong; ++k) kept += s.weights[k] > 0 ? 1 : 0;
      EXPECT_GE(kept, 18) << seed << " " << wrong;
      EXPECT_LT(error(s.T_world_node, w.truth), error(w.drifted, w.truth));
    }
  }
}

TEST(PoseGraph, DirectionsThatALoopDidNotSeeStayFree) {
  World w = circles(2, 0, 0);
  Edge loop{0, kNodes - 1, w.truth.front().inverse() * w.truth.back(), Matrix6d::Zero(), true};
  const GraphSolution without = optimise(w.drifted, w.edges);
  // Sees the distance along the last node's x and its turn about z, nothing else; and is wrong in
  // all that it does not see.
  loop.information(3, 3) = loop.information(2, 2) = 1e6;
  Vector6d rubbish;
  rubbish << 0.3, -0.4, 0, 0, 2, -3;
  Edge worse = loop;
  worse.T_from_to = loop.T_from_to * SE3::exp(rubbish);
  EXPECT_EQ(rank(loop.information), 2);
  const double before =
      std::abs(disagreement(loop, without.T_world_node.front(), without.T_world_node.back())[3]);
  w.edges.push_back(loop);
  const GraphSolution with = optimise(w.drifted, w.edges);
  const Vector6d e = disagreement(loop, with.T_world_node.front(), with.T_world_node.back());
  EXPECT_LT(std::abs(e[3]), 0.05 * before + 1e-6);
  EXPECT_LT(std::abs(e[2]), 1e-3);
  // Where drift leaves e small, what the loop says of unseen directions changes nothing.
  Matrix6d none = Matrix6d::Zero();
  w.edges.back() = worse;
  w.edges.back().information = none;
  w.edges.back().information(3, 3) = 1e-300;
  const GraphSolution free = optimise(w.drifted, w.edges);
  for (int k = 0; k < kNodes; ++k) {
    const auto n = static_cast<std::size_t>(k);
    EXPECT_LT((free.T_world_node[n].inverse() * without.T_world_node[n]).log().norm(), 1e-9);
  }
}

TEST(PoseGraph, DoesNotDependOnWhereTheWorldIs) {
  const World w = circles(3, 10, 2);
  const GraphSolution here = optimise(w.drifted, w.edges);
  const SE3 far(so3_exp({0.3, -0.2, 0.5}), {100, -40, 20});
  std::vector<SE3> moved;
  for (const SE3& T : w.drifted) moved.push_back(far * T);
  const GraphSolution there = optimise(moved, w.edges);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    EXPECT_LT(((far * here.T_world_node[k]).inverse() * there.T_world_node[k]).log().norm(), 1e-7);
  }
}

TEST(PoseGraph, SaysWhereThereIsNoSolution) {
  World w = circles(3, 10, 2);
  EXPECT_TRUE(optimise(w.drifted, w.edges).found);
  w.edges[3].T_from_to.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(optimise(w.drifted, w.edges).found);
}

TEST(PoseGraph, EdgesThatJoinNothingAreRefused) {
  EXPECT_THROW(optimise({SE3{}}, {{0, 1, {}, Matrix6d::Identity(), false}}), ContractViolation);
  EXPECT_THROW(optimise({SE3{}, SE3{}}, {{1, 1, {}, Matrix6d::Identity(), false}}),
               ContractViolation);
}

}  // namespace
}  // namespace sgs::graph
