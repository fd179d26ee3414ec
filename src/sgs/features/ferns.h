// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sgs/camera/rgbd_frame.h"

namespace sgs::features {

/// What the ferns see of a frame: one byte each, four bits used, kUnknown where depth is missing.
using FernCode = std::vector<std::uint8_t>;

/// Randomised ferns (Glocker, Shotton, Criminisi, Izadi: Real-Time RGB-D Camera Relocalization via
/// Randomized Ferns for Keyframe Encoding, TVCG 2015): how alike two views are, from a few hundred
/// yes-or-no questions to each. Where the paper compares pixels with thresholds, these compare
/// pixels with each other, so that a change of exposure answers nothing differently: brightness of
/// two pairs of places, redness of one pair, depth of one pair. No vocabulary, no training.
/// Immutable; thread-safe.
class Ferns {
 public:
  static constexpr std::uint8_t kUnknown = 0xff;

  /// `seed` decides the questions; codes of different seeds cannot be compared.
  explicit Ferns(std::uint64_t seed, int count = 640);

  FernCode code(const RgbdFrame& frame) const;
  /// Share of equal answers among the ferns that both views answer, 0..1; 0 where there are hardly
  /// any. Two views that have nothing to do with each other have about 0.1.
  static double similarity(const FernCode& a, const FernCode& b);

 private:
  struct Pair {
    int a, b;  // cells of the coarse image
  };
  struct Fern {
    Pair gray[2], redness, depth;
  };
  std::vector<Fern> ferns_;
};

}  // namespace sgs::features
