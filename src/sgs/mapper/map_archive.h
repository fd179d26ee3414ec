// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "sgs/core/archive.h"
#include "sgs/map/gaussian_set.h"
#include "sgs/map/gaussian_store.h"

template <>
inline constexpr bool sgs::archived_as_bytes<sgs::map::Gaussian> = true;
template <>
inline constexpr bool sgs::archived_as_bytes<sgs::map::Moments> = true;

namespace sgs::map {

// The map's types as fields of an archive.

template <class Archive>
void archive_fields(Archive& a, Anchor& anchor) {
  a(anchor.point, anchor.normal, anchor.sigma_n_m, anchor.keyframe, anchor.id);
}

template <class Archive>
void archive_fields(Archive& a, GaussianStore& store) {
  a(store.raw, store.average, store.moments, store.steps, store.max_log_scale, store.anchors,
    store.next_id);
}

/// Whether the arrays fit each other; those of a file may not.
inline bool consistent(const GaussianStore& store) {
  const std::size_t count = store.size();
  return store.average.size() == count && store.moments.size() == count &&
         store.steps.size() == count && store.max_log_scale.size() == count &&
         store.anchors.size() == count;
}

/// Which of the Gaussians that a set knows are in it, as words; and the set again.
inline std::vector<std::uint64_t> words_of(const GaussianSet& set) {
  std::vector<std::uint64_t> words;
  words.reserve(set.size() / GaussianSet::kWord + 1);
  for (std::size_t w = 0; w * GaussianSet::kWord < set.size(); ++w) words.push_back(set.maybe(w));
  const std::size_t rest = set.size() % GaussianSet::kWord;
  if (rest > 0) words.back() &= (std::uint64_t{1} << rest) - 1;
  return words;
}
inline void assign_words(const std::vector<std::uint64_t>& words, std::size_t size,
                         GaussianSet& set) {
  set.clear(size);
  for (std::size_t w = 0; w < words.size(); ++w) {
    for (std::uint64_t left = words[w]; left != 0; left &= left - 1) {
      const auto index = w * GaussianSet::kWord + static_cast<std::size_t>(std::countr_zero(left));
      if (index < size) set.insert(index);
    }
  }
}

template <class Archive>
void archive_fields(Archive& a, GaussianSet& set) {
  std::uint64_t size = set.size();
  std::vector<std::uint64_t> words = words_of(set);
  a(size, words);
  if (words.size() != size / GaussianSet::kWord + (size % GaussianSet::kWord != 0 ? 1 : 0)) {
    return a.fail();
  }
  if constexpr (Archive::kReads) assign_words(words, static_cast<std::size_t>(size), set);
}

}  // namespace sgs::map
