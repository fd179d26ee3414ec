// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sgs/core/archive.h"
#include "sgs/core/random.h"

namespace sgs::mapper {

/// The order in which weighted views are visited: each as often as its weight says, spread over
/// time as evenly as shuffled rounds are.
class BalancedOrder {
 public:
  /// One more view; its weight is positive by the time it may come.
  void add(double weight, SplitMix64& random);
  void set_weight(std::size_t view, double weight) { entries_[view].weight = weight; }
  /// The view that comes next, of those in `active`; there must be one.
  std::size_t next(std::span<const std::size_t> active, SplitMix64& random);
  /// Counts that a view came, by this order or another way; how often it has by now.
  int count_visit(std::size_t view) { return ++entries_[view].visits; }
  std::size_t size() const { return entries_.size(); }
  /// False for what no order can be: read from a file.
  bool consistent() const;

  template <class Archive>
  void archive(Archive& a) {
    a(entries_);
  }

 private:
  /// `credit` grows with every step by the share that the view should have had of it; the one with
  /// the most comes next and pays a whole step. The jitter, drawn anew each time, keeps views from
  /// following each other in the same order for ever.
  struct Entry {
    double credit = 0, jitter = 0, weight = 0;
    int visits = 0;

    template <class Archive>
    void archive(Archive& a) {
      a(credit, jitter, weight, visits);
    }
  };
  std::vector<Entry> entries_;
};

}  // namespace sgs::mapper
