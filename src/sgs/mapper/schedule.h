// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/core/archive.h"
#include "sgs/core/random.h"
#include "sgs/mapper/balanced_order.h"
#include "sgs/mapper/mapper_config.h"

namespace sgs::mapper {

/// Which keyframe is optimised next: a new keyframe once, then in an order that mixes all.
///
/// Where all come equally often, the k-th of n keyframes has had s ln(n / k) visits in the end, s
/// being the steps per keyframe: the newest have next to none. Where the least visited comes first,
/// the last views win over what others have taught. `kBalanced` lies between: a
/// keyframe comes with a frequency in proportion to (visits + 4)^-bias, spread over time as evenly
/// as shuffled rounds are (`kRounds`: every keyframe once in each).
class Schedule {
 public:
  /// `visit_bias` is the exponent of kBalanced.
  Schedule(std::uint64_t seed, VisitOrder order, double visit_bias)
      : random_(seed), order_(order), visit_bias_(visit_bias) {}
  /// Announces keyframe number `index`; it comes next.
  void add_keyframe(std::size_t index);
  /// That one does not come any more. Another one must be left.
  void cull(std::size_t index);
  /// Those that come, in order.
  const std::vector<std::size_t>& active() const { return active_; }
  /// Number of the keyframe to optimise; there must be one.
  std::size_t next();
  SplitMix64& random() { return random_; }
  std::size_t keyframes() const { return count_; }
  /// False for what no schedule can be: read from a file.
  bool consistent() const;

  template <class Archive>
  void archive(Archive& a) {
    a(random_, count_, active_, fresh_, round_, balanced_);
  }

 private:
  std::size_t next_in_round();
  void count_visit(std::size_t index);

  SplitMix64 random_;
  VisitOrder order_;
  double visit_bias_;
  std::size_t count_ = 0;
  std::vector<std::size_t> active_;
  std::vector<std::size_t> fresh_;  ///< announced, not yet visited
  std::vector<std::size_t> round_;  ///< kRounds: what is left of the current round, last first
  BalancedOrder balanced_;
};

}  // namespace sgs::mapper
