// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/expected_motion.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sgs::alignment {
namespace {

constexpr std::size_t kFewest = 5, kMost = 60;  // frames
// Median of a squared norm of three, in variances of one.
constexpr double kMedianOfThree = 2.366;
constexpr double kFreedom = 4;  // degrees, of Student's t
// Points and pixels count as if each erred by itself, but neighbours err together: their equations
// are too sure, and a prior beside them has to be as sure.
constexpr double kWeight = 3;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void ExpectedMotion::expect(const std::optional<SE3>& T_local_camera) {
  expected_ = T_local_camera;
}

void ExpectedMotion::learn(const SE3& T_local_camera) {
  if (!expected_) return;
  surprises_.emplace_back((expected_->inverse() * T_local_camera).log());
  if (surprises_.size() > kMost) surprises_.pop_front();
  if (surprises_.size() < kFewest) return;
  std::vector<double> turns, moves;
  for (const Vector6d& surprise : surprises_) {
    turns.push_back(surprise.head<3>().squaredNorm());
    moves.push_back(surprise.tail<3>().squaredNorm());
  }
  const double turn = median(std::move(turns)), move = median(std::move(moves));
  information_.setZero();
  if (!(turn > 0 && move > 0)) return;  // a film that stands still
  information_.diagonal().head<3>().setConstant(kMedianOfThree / turn);
  information_.diagonal().tail<3>().setConstant(kMedianOfThree / move);
}

std::optional<degeneracy::AxisPrior> ExpectedMotion::prior(const SE3& T_local_camera) const {
  if (!expected_ || information_.isZero(0)) return {};
  const Vector6d e = (expected_->inverse() * T_local_camera).log();
  degeneracy::AxisPrior out;
  out.T_prior = *expected_;
  out.weight = kWeight * (kFreedom + 6) / (kFreedom + e.dot(information_ * e)) * information_;
  return out;
}

}  // namespace sgs::alignment
