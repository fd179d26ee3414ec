// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/balanced_order.h"

#include <algorithm>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs::mapper {

void BalancedOrder::add(double weight, SplitMix64& random) {
  const double jitter = random.uniform();
  entries_.push_back({jitter, jitter, weight, 0});
}

std::size_t BalancedOrder::next(std::span<const std::size_t> active, SplitMix64& random) {
  SGS_CHECK(!active.empty(), "an order needs something to order");
  double sum = 0;
  for (const std::size_t i : active) sum += entries_[i].weight;
  std::size_t best = active.front();
  for (const std::size_t i : active) {
    entries_[i].credit += entries_[i].weight / sum;
    if (entries_[i].credit > entries_[best].credit) best = i;
  }
  Entry& entry = entries_[best];
  const double jitter = random.uniform();
  entry.credit += jitter - entry.jitter - 1;
  entry.jitter = jitter;
  return best;
}

bool BalancedOrder::consistent() const {
  return std::ranges::all_of(
      entries_, [](const Entry& e) { return std::isfinite(e.credit) && e.visits >= 0; });
}

}  // namespace sgs::mapper
