// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/terms/trial.h"

#include <cmath>

namespace sgs::alignment {
namespace {

// What was not seen for so long is new when it is seen again.
constexpr double kLongestGap_s = 0.5;

std::uint64_t cell_at(const Eigen::Vector3f& point) {
  constexpr float kCell_m = 0.05f;
  constexpr std::int64_t kMiddle = 1 << 20;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::int64_t>(std::floor(point[axis] / kCell_m)) + kMiddle;
    key = key << 21 | (static_cast<std::uint64_t>(i) & ((1u << 21) - 1));
  }
  return key;
}

}  // namespace

void Trial::see(const Eigen::Vector3f& point, double time_s) {
  const auto [cell, added] = cells_.try_emplace(cell_at(point), Seen{time_s, time_s});
  if (added) return;
  if (time_s - cell->second.last_s > kLongestGap_s) cell->second.first_s = time_s;
  cell->second.last_s = time_s;
}

bool Trial::stayed(const Eigen::Vector3f& point, double time_s) const {
  const auto cell = cells_.find(cell_at(point));
  return cell != cells_.end() && time_s - cell->second.last_s <= kLongestGap_s &&
         time_s - cell->second.first_s >= trial_s_;
}

void Trial::forget(double time_s) {
  std::erase_if(cells_,
                [&](const auto& cell) { return time_s - cell.second.last_s > kLongestGap_s; });
}

}  // namespace sgs::alignment
