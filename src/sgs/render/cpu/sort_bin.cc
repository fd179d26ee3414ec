// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/sort_bin.h"

#include <algorithm>
#include <array>

namespace sgs::render::cpu {
namespace {

constexpr std::uint32_t kDigitBits = 11, kDigits = 1u << kDigitBits, kDigitMask = kDigits - 1;
using Histogram = std::array<std::uint32_t, kDigits>;

void exclusive_sum(Histogram& counts) {
  std::uint32_t sum = 0;
  for (auto& c : counts) {
    const std::uint32_t n = c;
    c = sum;
    sum += n;
  }
}

template <class Body>
void for_each_tile(const TileRect& r, int tiles_x, const Body& body) {
  for (int y = r.y0; y <= r.y1; ++y) {
    for (int x = r.x0; x <= r.x1; ++x) body(static_cast<std::size_t>(y * tiles_x + x));
  }
}

}  // namespace

void TileLists::build(std::span<const std::uint32_t> visible, const std::uint32_t* keys,
                      const TileRect* rects, int tiles_x, int tiles_y, ThreadPool& pool) {
  sort(visible, keys);
  deal(rects, tiles_x, tiles_x * tiles_y, pool);
}

/// Radix sort in two passes of 11 bits, the first of which reads the chunks where they lie.
void TileLists::sort(std::span<const std::uint32_t> visible, const std::uint32_t* keys) {
  Histogram low{}, high{};
  total_ = 0;
  for (std::size_t c = 0; c < visible.size(); ++c) {
    const std::uint32_t* k = keys + c * kChunk;
    for (std::uint32_t i = 0; i < visible[c]; ++i) {
      ++low[k[i] & kDigitMask];
      ++high[k[i] >> kDigitBits];
    }
    total_ += visible[c];
  }
  exclusive_sum(low);
  exclusive_sum(high);
  half_keys_.ensure(total_);
  half_ids_.ensure(total_);
  sorted_.ensure(total_);
  for (std::size_t c = 0; c < visible.size(); ++c) {
    const auto first = static_cast<std::uint32_t>(c * kChunk);
    for (std::uint32_t i = first; i < first + visible[c]; ++i) {
      const std::uint32_t to = low[keys[i] & kDigitMask]++;
      half_keys_[to] = keys[i] >> kDigitBits;
      half_ids_[to] = i;
    }
  }
  for (std::uint32_t i = 0; i < total_; ++i) sorted_[high[half_keys_[i]]++] = half_ids_[i];
}

/// Counting sort by tile. Each part of the sorted order counts and deals on its own; as the parts
/// follow one another within each tile, the outcome does not depend on their number.
void TileLists::deal(const TileRect* rects, int tiles_x, int tiles, ThreadPool& pool) {
  const int parts = pool.threads();
  const auto n = static_cast<std::size_t>(tiles);
  cursors_.resize(static_cast<std::size_t>(parts));
  const auto range = [&](int part) {
    const auto at = [&](int p) {
      return static_cast<std::size_t>(total_) * static_cast<std::size_t>(p) /
             static_cast<std::size_t>(parts);
    };
    return std::span(sorted_.data() + at(part), at(part + 1) - at(part));
  };
  pool.run(parts, [&](int part, int) {
    auto& counts = cursors_[static_cast<std::size_t>(part)];
    counts.assign(n, 0);
    for (const std::uint32_t id : range(part)) {
      for_each_tile(rects[id], tiles_x, [&](std::size_t t) { ++counts[t]; });
    }
  });
  start_.resize(n + 1);
  std::uint32_t sum = 0;
  for (std::size_t t = 0; t < n; ++t) {
    start_[t] = sum;
    for (auto& counts : cursors_) {
      const std::uint32_t count = counts[t];
      counts[t] = sum;
      sum += count;
    }
  }
  start_[n] = sum;
  entries_.ensure(sum);
  pool.run(parts, [&](int part, int) {
    auto& cursor = cursors_[static_cast<std::size_t>(part)];
    for (const std::uint32_t id : range(part)) {
      for_each_tile(rects[id], tiles_x, [&](std::size_t t) { entries_[cursor[t]++] = id; });
    }
  });
}

}  // namespace sgs::render::cpu
