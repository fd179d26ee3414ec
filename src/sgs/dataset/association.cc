// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/association.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/core/error.h"

namespace sgs::dataset {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// A candidate pair as the end of the best chain that leads to it.
struct Link {
  std::size_t i, j, previous, pairs;
  double cost_s;
};

bool better(const Link& x, const Link& y) {
  return x.pairs != y.pairs ? x.pairs > y.pairs : x.cost_s < y.cost_s;
}

/// Fenwick tree over j of the best link that ends at or before it.
class PrefixBest {
 public:
  explicit PrefixBest(std::size_t size) : tree_(size + 1, kNone) {}
  std::size_t before(std::size_t j, const std::vector<Link>& links) const {
    std::size_t result = kNone;
    for (; j > 0; j -= j & (~j + 1)) result = choose(result, tree_[j], links);
    return result;
  }
  void insert(std::size_t link, const std::vector<Link>& links) {
    for (std::size_t at = links[link].j + 1; at < tree_.size(); at += at & (~at + 1)) {
      tree_[at] = choose(tree_[at], link, links);
    }
  }

 private:
  static std::size_t choose(std::size_t x, std::size_t y, const std::vector<Link>& links) {
    if (x == kNone || y == kNone) return x == kNone ? y : x;
    return better(links[y], links[x]) ? y : x;
  }
  std::vector<std::size_t> tree_;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double max_difference_s) {
  SGS_CHECK(std::is_sorted(a.begin(), a.end()) && std::is_sorted(b.begin(), b.end()),
            "times to associate must be sorted");
  // Sorted times never need crossing pairs, so the best set is a chain of candidates that increases
  // in both i and j: a longest-chain search with the best prefix over j kept in a Fenwick tree.
  std::vector<Link> links;
  PrefixBest best(b.size());
  std::size_t begin = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (begin < b.size() && b[begin] < a[i] - max_difference_s) ++begin;
    const std::size_t first_of_i = links.size();
    // Times in a wrong unit lie all within the tolerance: the nearest will do, or memory would grow
    // with the square of their number.
    constexpr std::size_t kCandidates = 64;
    const auto nearest = static_cast<std::size_t>(
        std::lower_bound(b.begin() + static_cast<std::ptrdiff_t>(begin), b.end(), a[i]) -
        b.begin());
    const std::size_t from = std::max(begin, nearest - std::min(nearest, kCandidates / 2));
    const std::size_t to = std::min(b.size(), from + kCandidates);
    for (std::size_t j = from; j < to && b[j] <= a[i] + max_difference_s; ++j) {
      const std::size_t previous = best.before(j, links);
      Link link{i, j, previous, 1, std::abs(a[i] - b[j])};
      if (previous != kNone) {
        link.pairs += links[previous].pairs;
        link.cost_s += links[previous].cost_s;
      }
      links.push_back(link);
    }
    for (std::size_t k = first_of_i; k < links.size(); ++k) best.insert(k, links);
  }
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = best.before(b.size(), links); k != kNone; k = links[k].previous) {
    pairs.emplace_back(links[k].i, links[k].j);
  }
  std::reverse(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace sgs::dataset
