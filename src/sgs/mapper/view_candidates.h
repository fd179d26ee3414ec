// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sgs/core/archive.h"
#include "sgs/map/gaussian_set.h"
#include "sgs/map/packed_set.h"

namespace sgs::mapper {

/// Which Gaussians each keyframe sees. In a long session most of the map lies out of a keyframe's
/// view or behind walls, and stays there: most visits need not look at it. Every n-th visit looks
/// at everything and notes what it saw. The visits between look at that and at what was inserted
/// since, and note what they saw if there was any.
class ViewCandidates {
 public:
  /// What a visit looks at and where it notes what it saw; null = everything, nowhere.
  struct Visit {
    const map::GaussianSet* candidates = nullptr;
    map::GaussianSet* reached = nullptr;
  };

  /// Every `interval`-th visit of a keyframe looks at everything; 1 = all do and note nothing.
  explicit ViewCandidates(int interval) : interval_(interval) {}
  /// The next visit of a keyframe, to a map of so many Gaussians. Valid until the next call.
  Visit next(std::size_t keyframe, std::size_t gaussians);
  /// Gaussians have moved: the next visit of each keyframe looks at everything.
  void forget();
  /// That keyframe is not visited any more.
  void forget(std::size_t keyframe);
  /// `removed` Gaussians are about to go, the others move up.
  void follow_removal(const map::GaussianSet& removed);
  /// False for what cannot be with so many keyframes and Gaussians: read from a file.
  bool consistent(std::size_t keyframes, std::size_t gaussians) const;
  /// Memory that it holds.
  std::size_t bytes() const { return bytes_; }

  template <class Archive>
  void archive(Archive& a) {
    keep();
    a(keyframes_);
    if constexpr (Archive::kReads) {
      for (const Keyframe& keyframe : keyframes_) bytes_ += keyframe.seen.bytes();
    }
  }

 private:
  struct Keyframe {
    int visits = 0;
    map::PackedSet seen;

    template <class Archive>
    void archive(Archive& a) {
      a(visits, seen);
    }
  };
  /// Packs what the last visit has noted.
  void keep();

  int interval_;
  std::vector<Keyframe> keyframes_;
  std::size_t bytes_ = 0;              // of keyframes_
  map::GaussianSet seen_;              // of the last visit
  std::optional<std::size_t> noting_;  // the keyframe whose visit notes in seen_
};

}  // namespace sgs::mapper
