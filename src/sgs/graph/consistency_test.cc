// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/graph/consistency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sgs/core/random.h"

namespace sgs::graph {
namespace {

Vector6d twist(double a, double b, double c, double x, double y, double z) {
  Vector6d xi;
  xi << a, b, c, x, y, z;
  return xi;
}

TEST(Consistency, CovariancesOfAChainAreThoseOfManyTries) {
  const UncertainPose a{SE3::exp(twist(0.3, 0.1, -0.4, 1, 2, 0.5)),
                        twist(1, 2, 1, 3, 1, 2).asDiagonal() * 1e-6};
  const UncertainPose b{SE3::exp(twist(-0.2, 0.5, 0.1, 0.3, -1, 2)),
                        twist(2, 1, 1, 1, 4, 1).asDiagonal() * 1e-6};
  const UncertainPose ab = a * inverse(b);
  SplitMix64 random(7);
  const auto sample = [&](const UncertainPose& p) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) {
      double sum = -6;
      for (int k = 0; k < 12; ++k) sum += random.uniform();
      xi[i] = sum * std::sqrt(p.covariance(i, i));
    }
    return p.T * SE3::exp(xi);
  };
  Matrix6d seen = Matrix6d::Zero();
  constexpr int kTries = 20000;
  for (int i = 0; i < kTries; ++i) {
    const Vector6d e = (ab.T.inverse() * (sample(a) * sample(b).inverse())).log();
    seen += e * e.transpose() / kTries;
  }
  EXPECT_LT((seen - ab.covariance).norm(), 0.05 * ab.covariance.norm());
  EXPECT_LT((ab.T.inverse() * (a.T * b.T.inverse())).log().norm(), 1e-12);
}

TEST(Consistency, ARoundThatClosesCostsNothing) {
  UncertainPose round{SE3{}, Matrix6d::Identity() * 1e-4};
  EXPECT_EQ(closure_chi2(round), 0);
  round.T = SE3::exp(twist(0, 0, 0, 0.02, 0, 0));
  EXPECT_NEAR(closure_chi2(round), 4, 1e-9);
}

TEST(Consistency, TheLargestSetThatAgreesIsFound) {
  // 1, 3, 4 agree with each other; 0-2 is a pair; 5 agrees with nobody.
  std::vector<std::uint64_t> agrees(6);
  const auto join = [&](int a, int b) {
    agrees[static_cast<std::size_t>(a)] |= std::uint64_t{1} << b;
    agrees[static_cast<std::size_t>(b)] |= std::uint64_t{1} << a;
  };
  join(1, 3);
  join(3, 4);
  join(1, 4);
  join(0, 2);
  EXPECT_EQ(largest_agreement(agrees), (std::vector<int>{1, 3, 4}));
  EXPECT_TRUE(largest_agreement({}).empty());
}

TEST(Consistency, AStormOfItemsEndsInBoundedTime) {
  // Every item agrees with a random half of the others: the worst there is for the search.
  SplitMix64 random(3);
  std::vector<std::uint64_t> agrees(64);
  for (std::size_t i = 0; i < 64; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (random.uniform() < 0.9) {
        agrees[i] |= std::uint64_t{1} << j;
        agrees[j] |= std::uint64_t{1} << i;
      }
    }
  }
  const std::vector<int> found = largest_agreement(agrees);
  EXPECT_GE(found.size(), 10u);
  for (const int a : found) {
    for (const int b : found) {
      EXPECT_TRUE(a == b || (agrees[static_cast<std::size_t>(a)] >> b & 1u) != 0);
    }
  }
}

}  // namespace
}  // namespace sgs::graph
