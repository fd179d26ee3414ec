// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sgs/map/harmonics.h"

namespace sgs::refine {

/// View-dependent colours while they are learnt, by Adam with its moments (Kingma & Ba 2015). Rows
/// follow those of the map's store. Thread-safe for disjoint Gaussians.
class LearnedHarmonics {
 public:
  /// `start` has the degree to learn; where it is for no Gaussians all begin at zero.
  explicit LearnedHarmonics(map::Harmonics start);

  const map::Harmonics& values() const { return values_; }
  int degree() const { return values_.degree; }
  bool empty() const { return values_.empty(); }
  /// Of Adam.
  void set_rate(double rate);
  /// New Gaussians at the end look the same from everywhere.
  void resize(std::size_t count);
  /// Step number `t` (from 1) of Gaussian `i`. No coefficient grows beyond kLargestHarmonic, so
  /// that every format shows what was learnt.
  void step(std::size_t i, std::uint32_t t, std::span<const float> gradient);
  /// Removes those that are not 0 in `removed`, keeping the order.
  void remove(std::span<const char> removed);
  /// A Gaussian was split in two: one half took its place, the other comes at the end.
  void split(std::size_t i);

 private:
  map::Harmonics values_;
  std::vector<float> mean_, mean_square_;         // moments of the gradient
  std::vector<float> correction1_, correction2_;  // 1/(1-b1^t), 1/sqrt(1-b2^t)
  float rate_ = 0;
};

}  // namespace sgs::refine
