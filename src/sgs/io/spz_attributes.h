// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"

namespace sgs::io {

/// How the attributes of an SPZ file are stored, whatever it is packed in.
struct SpzLayout {
  std::size_t count = 0;    ///< Gaussians
  int harmonic_degree = 0;  ///< 0 = none
  int fractional_bits = 0;  ///< of a coordinate
  /// Rotations: the three smallest components and which one is left out, 4 bytes (versions 3 and
  /// 4); else x y z with w >= 0 left out, 3 bytes (version 2).
  bool smallest_three = false;

  /// The attributes, in the order of the file.
  enum Attribute { kPositions, kOpacities, kColors, kScales, kRotations, kHarmonics };
  static constexpr std::size_t kAttributes = 6;
  /// Bytes of one of them, of all Gaussians.
  std::array<std::size_t, kAttributes> bytes() const;
};

/// Fractional bits that leave room for the largest coordinate, at most 16; empty: beyond 8388 km.
std::optional<int> spz_fractional_bits(std::span<const map::Gaussian> splats);

/// The attributes of finite Gaussians, each layout.bytes() long. Axes are turned from ours (x
/// right, y down, z forward) to SPZ's (x right, y up, z back).
std::array<std::string, SpzLayout::kAttributes> spz_attributes(
    std::span<const map::Gaussian> splats, const map::Harmonics& harmonics,
    const SpzLayout& layout);

/// The Gaussians that they stand for, in our axes; each must be layout.bytes() long.
map::SplatMap splats_from_spz(
    const std::array<std::string_view, SpzLayout::kAttributes>& attributes,
    const SpzLayout& layout);

}  // namespace sgs::io
