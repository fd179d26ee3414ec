// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/graph/consistency.h"

#include <Eigen/Cholesky>
#include <bit>

#include "sgs/core/error.h"

namespace sgs::graph {
namespace {

class CliqueSearch {
 public:
  explicit CliqueSearch(const std::vector<std::uint64_t>& agrees) : agrees_(agrees) {}

  std::uint64_t run() {
    const std::size_t n = agrees_.size();
    extend(0, n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1);
    return best_;
  }

 private:
  // Bounds the cost of a storm of items that agree in part: the best found so far counts then.
  static constexpr int kMostCalls = 200000;

  void extend(std::uint64_t chosen, std::uint64_t candidates) {
    if (++calls_ > kMostCalls) return;
    if (candidates == 0) {
      if (std::popcount(chosen) > std::popcount(best_)) best_ = chosen;
      return;
    }
    while (candidates != 0) {
      if (std::popcount(chosen) + std::popcount(candidates) <= std::popcount(best_)) return;
      const int item = std::countr_zero(candidates);
      const std::uint64_t bit = std::uint64_t{1} << item;
      candidates &= ~bit;
      extend(chosen | bit, candidates & agrees_[static_cast<std::size_t>(item)]);
    }
  }

  const std::vector<std::uint64_t>& agrees_;
  std::uint64_t best_ = 0;
  int calls_ = 0;
};

}  // namespace

Matrix6d carried(const Matrix6d& covariance, const SE3& T) {
  const Matrix6d A = T.adjoint();
  return A * covariance * A.transpose();
}

Matrix6d covariance_of(const Matrix6d& information) {
  Matrix6d bounded = information;
  bounded.diagonal().array() += 1;
  return bounded.inverse();
}

UncertainPose operator*(const UncertainPose& a, const UncertainPose& b) {
  return {a.T * b.T, carried(a.covariance, b.T.inverse()) + b.covariance};
}

UncertainPose inverse(const UncertainPose& a) {
  return {a.T.inverse(), carried(a.covariance, a.T)};
}

double closure_chi2(const UncertainPose& round) {
  const Vector6d e = round.T.log();
  return e.dot(round.covariance.ldlt().solve(e));
}

std::vector<int> largest_agreement(const std::vector<std::uint64_t>& agrees) {
  SGS_CHECK(agrees.size() <= 64, "at most 64 items");
  std::uint64_t best = CliqueSearch(agrees).run();
  std::vector<int> out;
  for (; best != 0; best &= best - 1) out.push_back(std::countr_zero(best));
  return out;
}

}  // namespace sgs::graph
