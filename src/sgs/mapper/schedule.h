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

/// Which keyframe is optimised next: a new keyframe once, then shuffled rounds in which every
/// keyframe comes exactly once (or random draws). With sign-like Adam steps the last views win, so
/// no view may come more often than others (MAPPING, "Order").
class Schedule {
 public:
  Schedule(std::uint64_t seed, bool rounds) : random_(seed), rounds_(rounds) {}
  /// Announces keyframe number `index`; it comes next.
  void add_keyframe(std::size_t index);
  /// Number of the keyframe to optimise; there must be one.
  std::size_t next();
  Random& random() { return random_; }

 private:
  Random random_;
  bool rounds_;
  std::size_t count_ = 0;
  std::vector<std::size_t> fresh_;  ///< announced, not yet visited
  std::vector<std::size_t> round_;  ///< what is left of the current round, last first
};

}  // namespace sgs::mapper
