// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/packed_set.h"

#include <bit>

#include "sgs/core/error.h"

namespace sgs::map {
namespace {

constexpr std::size_t kWord = GaussianSet::kWord;

std::size_t words_for(std::size_t count) { return count / kWord + (count % kWord != 0 ? 1 : 0); }

/// Words of a packed set that say which words are there.
std::size_t marks_for(std::size_t size) { return words_for(words_for(size)); }

/// Calls `visit(number, word)` for each word that is there, in order.
template <class Visitor>
void for_each_word(const std::vector<std::uint64_t>& packed, std::size_t marks, Visitor visit) {
  std::size_t next = marks;
  for (std::size_t m = 0; m < marks; ++m) {
    for (std::uint64_t left = packed[m]; left != 0; left &= left - 1) {
      visit(m * kWord + static_cast<std::size_t>(std::countr_zero(left)), packed[next++]);
    }
  }
}

/// Packs words that come in order.
class Packer {
 public:
  explicit Packer(std::size_t size) : packed_(marks_for(size), 0) {}

  /// Adds to word number `word`, which is the last one or comes behind it.
  void add(std::size_t word, std::uint64_t bits) {
    if (bits == 0) return;
    std::uint64_t& mark = packed_[word / kWord];
    const std::uint64_t bit = std::uint64_t{1} << (word % kWord);
    if ((mark & bit) != 0) {
      packed_.back() |= bits;
      return;
    }
    mark |= bit;
    packed_.push_back(bits);
  }
  /// At its size: there are thousands.
  std::vector<std::uint64_t> take() { return {packed_.begin(), packed_.end()}; }

 private:
  std::vector<std::uint64_t> packed_;
};

}  // namespace

Removal::Removal(const GaussianSet& removed) : removed_(removed) {
  std::size_t sum = 0;
  for (std::size_t w = 0; w < words_for(removed.size()); ++w) {
    before_.push_back(sum);
    sum += static_cast<std::size_t>(std::popcount(removed.word(w)));
  }
}

PackedSet::PackedSet(const GaussianSet& set) : size_(set.size()) {
  Packer packer(size_);
  for (std::size_t w = 0; w < words_for(size_); ++w) packer.add(w, set.word(w));
  packed_ = packer.take();
}

void PackedSet::unpack(GaussianSet& set) const {
  set.clear(size_);
  for_each_word(packed_, marks_for(size_),
                [&](std::size_t w, std::uint64_t bits) { set.insert_word(w, bits); });
}

void PackedSet::follow_removal(const Removal& removal) {
  const GaussianSet& removed = removal.removed();
  SGS_CHECK(removed.size() >= size_, "the removed Gaussians belong to another map");
  if (size_ == 0) return;
  // Those before the set's end: the last word may reach beyond it.
  const std::size_t last = words_for(size_) - 1;
  const std::uint64_t within =
      size_ % kWord == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << (size_ % kWord)) - 1;
  const std::size_t kept = size_ - removal.before(last) -
                           static_cast<std::size_t>(std::popcount(removed.word(last) & within));
  Packer packer(kept);
  for_each_word(packed_, marks_for(size_), [&](std::size_t w, std::uint64_t bits) {
    // From the top, so that the places below stay what they are.
    for (std::uint64_t gone = removed.word(w); gone != 0; gone &= ~std::bit_floor(gone)) {
      const std::uint64_t below = std::bit_floor(gone) - 1;
      bits = (bits & below) | (bits >> 1 & ~below);
    }
    const std::size_t at = w * kWord - removal.before(w);
    packer.add(at / kWord, bits << (at % kWord));
    if (at % kWord != 0) packer.add(at / kWord + 1, bits >> (kWord - at % kWord));
  });
  packed_ = packer.take();
  size_ = kept;
}

// What a file says is believed only where nothing can go out of bounds by it.
bool PackedSet::consistent() const {
  const std::size_t marks = marks_for(size_);
  if (packed_.size() < marks) return false;
  std::size_t words = 0, beyond = 0;
  for (std::size_t m = 0; m < marks; ++m) {
    words += static_cast<std::size_t>(std::popcount(packed_[m]));
  }
  if (packed_.size() != marks + words) return false;
  for_each_word(packed_, marks, [&](std::size_t w, std::uint64_t bits) {
    const auto last = w * kWord + static_cast<std::size_t>(std::bit_width(bits));
    beyond += bits == 0 || w >= words_for(size_) || last > size_ ? 1 : 0;
  });
  return beyond == 0;
}

}  // namespace sgs::map
