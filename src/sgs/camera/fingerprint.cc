// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/fingerprint.h"

#include <algorithm>
#include <bit>

namespace sgs {
namespace {

/// FNV-1a (Fowler, Noll, Vo), 64 bits, folded to 48.
class Fnv {
 public:
  void add(std::uint64_t value) {
    constexpr std::uint64_t kPrime = 0x100000001b3ULL;
    hash_ = (hash_ ^ value) * kPrime;
  }
  std::int64_t folded() const {
    constexpr int kUsed = 48;
    const std::uint64_t bits = (hash_ ^ (hash_ >> kUsed)) & ((std::uint64_t{1} << kUsed) - 1);
    return static_cast<std::int64_t>(std::max<std::uint64_t>(bits, 1));
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

/// An odd stride walks through all columns of an image of the usual sizes.
std::size_t stride_of(std::size_t pixels) {
  constexpr std::size_t kPixels = 2048;
  return std::max<std::size_t>(1, pixels / kPixels) | 1;
}

}  // namespace

std::int64_t fingerprint(const RgbdFrame& frame) {
  Fnv hash;
  hash.add(static_cast<std::uint64_t>(frame.color.width()));
  hash.add(static_cast<std::uint64_t>(frame.color.height()));
  const std::size_t count = frame.color.size();
  for (std::size_t i = 0; i < count; i += stride_of(count)) {
    const Rgb8& c = frame.color.data()[i];
    const bool measured = i < frame.depth.size() && frame.depth.data()[i] > 0;
    hash.add(std::uint64_t{c.r} | std::uint64_t{c.g} << 8 | std::uint64_t{c.b} << 16 |
             std::uint64_t{measured} << 24);
  }
  return hash.folded();
}

std::int64_t depth_fingerprint(const RgbdFrame& frame) {
  Fnv hash;
  const std::size_t count = frame.depth.size();
  for (std::size_t i = 0; i < count; i += stride_of(count)) {
    hash.add(std::bit_cast<std::uint32_t>(frame.depth.data()[i]));
  }
  return hash.folded();
}

}  // namespace sgs
