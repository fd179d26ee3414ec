// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace sgs::mapper {

/// Small deterministic generator (SplitMix64, Steele et al. 2014) with its own mappings, so that
/// results do not depend on a library's distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, count).
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(uniform() * static_cast<double>(count));
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

 private:
  std::uint64_t state_;
};

/// Which keyframe is optimised next: a new keyframe once, then in an order that mixes all.
///
/// Where all come equally often, the k-th of n keyframes has had s ln(n / k) visits in the end, s
/// being the steps per keyframe: the newest have next to none. Where the least visited comes first,
/// the last views win over what others have taught (docs/mapping.md, section 5). `kBalanced` lies
/// between: a keyframe comes with a frequency in proportion to (visits + 4)^-bias, spread over time
/// as evenly as shuffled rounds are.
class Schedule {
 public:
  enum class Order {
    kBalanced,
    kRounds,  ///< shuffled rounds in which every keyframe comes once
    kRandom,
  };

  /// `visit_bias` is the exponent of kBalanced.
  Schedule(std::uint64_t seed, Order order, double visit_bias)
      : random_(seed), order_(order), visit_bias_(visit_bias) {}
  /// Announces keyframe number `index`; it comes next.
  void add_keyframe(std::size_t index);
  /// Number of the keyframe to optimise; there must be one.
  std::size_t next();
  Random& random() { return random_; }

 private:
  std::size_t next_in_round();
  std::size_t next_balanced();
  void count_visit(std::size_t index);

  Random random_;
  Order order_;
  double visit_bias_;
  std::size_t count_ = 0;
  std::vector<std::size_t> fresh_;  ///< announced, not yet visited
  std::vector<std::size_t> round_;  ///< kRounds: what is left of the current round, last first

  /// kBalanced: `credit` grows with every step by the share that the keyframe should have had of
  /// it; the one with the most comes next and pays a whole step. The jitter, drawn anew each time,
  /// keeps keyframes from following each other in the same order for ever.
  struct Entry {
    double credit, jitter, weight;
    int visits;
  };
  std::vector<Entry> entries_;
};

}  // namespace sgs::mapper
