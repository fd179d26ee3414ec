// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/gaussian_set.h"

#include <algorithm>
#include <bit>

#include "sgs/core/error.h"

namespace sgs::map {

std::size_t GaussianSet::count() const {
  std::size_t sum = 0;
  for (const std::uint64_t word : words_) sum += static_cast<std::size_t>(std::popcount(word));
  return sum;
}

void GaussianSet::follow_removal(const GaussianSet& removed) {
  SGS_CHECK(removed.size() >= size_, "the removed Gaussians belong to another map");
  std::size_t kept = 0;  // bits of the outcome so far
  for (std::size_t w = 0; w < words_.size(); ++w) {
    const std::size_t present = std::min(kWord, size_ - w * kWord);
    std::uint64_t bits = words_[w], gone = removed.words_[w];
    if (present < kWord) gone &= ~(~std::uint64_t{0} << present);
    const std::size_t left = present - static_cast<std::size_t>(std::popcount(gone));
    // From the top, so that the places below stay what they are.
    for (; gone != 0; gone &= ~std::bit_floor(gone)) {
      const std::uint64_t below = std::bit_floor(gone) - 1;
      bits = (bits & below) | (bits >> 1 & ~below);
    }
    // The outcome never overtakes what is still to be read.
    words_[w] = 0;
    const std::size_t to = kept / kWord, shift = kept % kWord;
    words_[to] |= bits << shift;
    if (shift + left > kWord) words_[to + 1] |= bits >> (kWord - shift);
    kept += left;
  }
  size_ = kept;
  words_.resize((kept + kWord - 1) / kWord);
}

}  // namespace sgs::map
