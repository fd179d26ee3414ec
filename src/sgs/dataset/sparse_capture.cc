// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/sparse_capture.h"

#include <algorithm>
#include <optional>

namespace sgs::dataset {
namespace {

bool median_exceeds(std::vector<double> values, double limit) {
  if (values.empty()) return false;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle > limit;
}

}  // namespace

bool is_sparse(const std::vector<double>& times_s, const Trajectory& poses) {
  constexpr double kGap_s = 0.2, kStep_m = 0.15, kStep_rad = 0.17, kSameTime_s = 1e-6;
  std::vector<double> gaps_s, steps_m, steps_rad;
  std::optional<SE3> last;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (i > 0) gaps_s.push_back(times_s[i] - times_s[i - 1]);
    const auto pose = poses.at(times_s[i], kSameTime_s);
    if (pose && last) {
      const SE3 step = last->inverse() * *pose;
      steps_m.push_back(step.t.norm());
      steps_rad.push_back(step.angle());
    }
    last = pose;
  }
  return median_exceeds(std::move(gaps_s), kGap_s) || median_exceeds(std::move(steps_m), kStep_m) ||
         median_exceeds(std::move(steps_rad), kStep_rad);
}

}  // namespace sgs::dataset
