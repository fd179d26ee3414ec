// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sgs/map/gaussian_set.h"

namespace sgs::map {

/// Which Gaussians go, for sets that follow.
class Removal {
 public:
  /// `removed` must outlive this object.
  explicit Removal(const GaussianSet& removed);

  const GaussianSet& removed() const { return removed_; }
  /// How many go of those before word number `word`.
  std::size_t before(std::size_t word) const { return before_[word]; }

 private:
  const GaussianSet& removed_;
  std::vector<std::size_t> before_;
};

/// A GaussianSet at rest: of a large map a keyframe sees a corner, so its words are mostly empty.
class PackedSet {
 public:
  PackedSet() = default;
  explicit PackedSet(const GaussianSet& set);

  /// The set again.
  void unpack(GaussianSet& set) const;
  std::size_t size() const { return size_; }
  /// Memory beside the object itself.
  std::size_t bytes() const { return sizeof(std::uint64_t) * packed_.capacity(); }
  /// As GaussianSet::follow_removal().
  void follow_removal(const Removal& removal);

  template <class Archive>
  void archive(Archive& a) {
    std::uint64_t size = size_;
    a(size, packed_);
    size_ = static_cast<std::size_t>(size);
    if (!consistent()) {
      *this = {};
      a.fail();
    }
  }

 private:
  bool consistent() const;

  std::size_t size_ = 0;
  /// A bit for each word, whether anything is in it; then the words of which that is true.
  std::vector<std::uint64_t> packed_;
};

}  // namespace sgs::map
