// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sgs/core/error.h"

namespace sgs::dataset {

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double max_difference_s) {
  SGS_CHECK(std::is_sorted(a.begin(), a.end()) && std::is_sorted(b.begin(), b.end()),
            "times to associate must be sorted");
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    while (begin < b.size() && b[begin] < a[i] - max_difference_s) ++begin;
    for (std::size_t j = begin; j < b.size() && b[j] <= a[i] + max_difference_s; ++j) {
      candidates.emplace_back(std::abs(a[i] - b[j]), i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> used_a(a.size()), used_b(b.size());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (used_a[i] || used_b[j]) continue;
    used_a[i] = used_b[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace sgs::dataset
