// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/association.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

#include "sgs/core/error.h"

namespace sgs::dataset {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

TEST(Association, SmallCases) {
  EXPECT_EQ(associate({0.000, 0.012}, {0.010}, 0.02), (Pairs{{1, 0}}));
  EXPECT_EQ(associate({0, 1, 2}, {0.015, 1.03, 1.985}, 0.02), (Pairs{{0, 0}, {2, 2}}));
  EXPECT_EQ(associate({0.00, 0.03}, {0.014, 0.044}, 0.02), (Pairs{{0, 0}, {1, 1}}));
  // Taking the closest pair (1, 2) first would leave a[2] alone.
  EXPECT_EQ(associate({0.175, 0.211, 0.243}, {0.160, 0.194, 0.2267}, 0.02),
            (Pairs{{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_TRUE(associate({}, {1}, 0.02).empty());
  EXPECT_TRUE(associate({1}, {}, 0.02).empty());
  EXPECT_THROW(associate({1, 0}, {0}, 0.02), ContractViolation);
}

// Against exhaustive search over all one-to-one pairings of small random lists.
TEST(Association, IsOptimal) {
  std::mt19937_64 random(7);
  const auto times = [&] {
    std::vector<double> t(1 + random() % 6);
    for (double& v : t) v = static_cast<double>(random() % 1000) * 1e-4;
    std::sort(t.begin(), t.end());
    return t;
  };
  for (int round = 0; round < 300; ++round) {
    const auto a = times(), b = times();
    std::pair<int, double> best{0, 0};  // minus the pairs, cost
    std::vector<bool> used(b.size());
    const std::function<void(std::size_t, int, double)> search = [&](std::size_t i, int pairs,
                                                                     double cost) {
      best = std::min(best, {-pairs, cost});
      if (i == a.size()) return;
      search(i + 1, pairs, cost);
      for (std::size_t j = 0; j < b.size(); ++j) {
        if (used[j] || std::abs(a[i] - b[j]) > 0.02) continue;
        used[j] = true;
        search(i + 1, pairs + 1, cost + std::abs(a[i] - b[j]));
        used[j] = false;
      }
    };
    search(0, 0, 0);
    const Pairs pairs = associate(a, b, 0.02);
    double cost = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      cost += std::abs(a[pairs[k].first] - b[pairs[k].second]);
      if (k > 0) {
        EXPECT_LT(pairs[k - 1].first, pairs[k].first);
        EXPECT_LT(pairs[k - 1].second, pairs[k].second);
      }
    }
    EXPECT_EQ(static_cast<int>(pairs.size()), -best.first);
    EXPECT_NEAR(cost, best.second, 1e-12);
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// All pairs of these times would take 5.8 GB.
TEST(Association, DenseTimesDoNotMultiply) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto associate_dense = [] {
    const rlimit little{2u << 30, 2u << 30};  // address space
    setrlimit(RLIMIT_AS, &little);
    std::vector<double> a, b;
    for (int i = 0; i < 12'000; ++i) {
      a.push_back(1e-6 * i);
      b.push_back(1e-6 * i + 2e-7);
    }
    const Pairs pairs = associate(a, b, 0.02);
    std::_Exit(pairs.size() > a.size() * 99 / 100 ? 0 : 1);
  };
  EXPECT_EXIT(associate_dense(), testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace sgs::dataset
