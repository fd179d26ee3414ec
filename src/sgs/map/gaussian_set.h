// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sgs::map {

/// A set of Gaussians of a growing map, one bit each. It tells about the first size() Gaussians;
/// of those inserted later it knows nothing. Not thread-safe, but different words may be written
/// at once.
class GaussianSet {
 public:
  /// Gaussians per word, the same blocks as those of MeanBounds.
  static constexpr std::size_t kWord = 64;

  /// Makes it the empty set of `count` Gaussians.
  void clear(std::size_t count) {
    size_ = count;
    words_.assign((count + kWord - 1) / kWord, 0);
  }
  void insert(std::size_t index) { words_[index / kWord] |= bit(index); }
  bool contains(std::size_t index) const { return (words_[index / kWord] & bit(index)) != 0; }
  std::size_t size() const { return size_; }
  /// Number of Gaussians in the set.
  std::size_t count() const;
  /// Those of word number `word` that are in the set or that it knows nothing of.
  std::uint64_t maybe(std::size_t word) const {
    if ((word + 1) * kWord <= size_) return words_[word];
    if (word * kWord >= size_) return ~std::uint64_t{0};
    return words_[word] | ~std::uint64_t{0} << (size_ - word * kWord);
  }
  /// Word number `word`: one bit for each of its Gaussians, those beyond size() are 0.
  std::uint64_t word(std::size_t word) const { return words_[word]; }
  void insert_word(std::size_t word, std::uint64_t bits) { words_[word] |= bits; }
  /// Follows a removal of Gaussians that keeps the order of the others (GaussianStore::remove_if).
  /// `removed` tells about all Gaussians before it.
  void follow_removal(const GaussianSet& removed);

 private:
  static std::uint64_t bit(std::size_t index) { return std::uint64_t{1} << (index % kWord); }

  std::size_t size_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace sgs::map
