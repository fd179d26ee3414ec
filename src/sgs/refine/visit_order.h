// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sgs/core/random.h"

namespace sgs::refine {

/// In which order weighted frames are visited: each as often as its weight says, spread over time
/// as evenly as shuffled rounds are.
class VisitOrder {
 public:
  /// At least one weight; all positive.
  VisitOrder(std::vector<double> weights, std::uint64_t seed);
  std::size_t next();

 private:
  std::vector<double> weights_;  // sum 1
  /// Grows with every step by the weight; the one with the most comes next and pays a whole step.
  std::vector<double> credit_, jitter_;
  SplitMix64 random_;
};

}  // namespace sgs::refine
