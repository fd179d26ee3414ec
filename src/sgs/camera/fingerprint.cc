// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/fingerprint.h"

#include <algorithm>

namespace sgs {

std::int64_t fingerprint(const RgbdFrame& frame) {
  // FNV-1a (Fowler, Noll, Vo), 64 bits.
  constexpr std::uint64_t kBasis = 0xcbf29ce484222325ULL, kPrime = 0x100000001b3ULL;
  constexpr std::size_t kPixels = 2048;
  std::uint64_t hash = kBasis;
  const auto add = [&](std::uint64_t value) { hash = (hash ^ value) * kPrime; };
  add(static_cast<std::uint64_t>(frame.color.width()));
  add(static_cast<std::uint64_t>(frame.color.height()));
  const std::size_t count = frame.color.size();
  // An odd stride walks through all columns of an image of the usual sizes.
  const std::size_t stride = std::max<std::size_t>(1, count / kPixels) | 1;
  for (std::size_t i = 0; i < count; i += stride) {
    const Rgb8& c = frame.color.data()[i];
    const bool measured = i < frame.depth.size() && frame.depth.data()[i] > 0;
    add(std::uint64_t{c.r} | std::uint64_t{c.g} << 8 | std::uint64_t{c.b} << 16 |
        std::uint64_t{measured} << 24);
  }
  constexpr int kUsed = 48;
  const std::uint64_t folded = (hash ^ (hash >> kUsed)) & ((std::uint64_t{1} << kUsed) - 1);
  return static_cast<std::int64_t>(std::max<std::uint64_t>(folded, 1));
}

}  // namespace sgs
