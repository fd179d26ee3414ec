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

/// Calls `body(tile, counts)` for the tiles of `r`, where `counts` is 0 or 1. Most Gaussians touch
/// at most 2x2 tiles, in a pattern that no branch predictor guesses: those make four calls, some of
/// which do not count (their tiles may lie one column or row beyond the grid).
template <class Body>
void for_each_tile(const TileRect& r, int tiles_x, const Body& body) {
  const auto first = static_cast<std::size_t>(r.y0 * tiles_x + r.x0);
  const auto row = static_cast<std::size_t>(tiles_x);
  const std::uint32_t width = static_cast<std::uint32_t>(r.x1 - r.x0);
  const std::uint32_t height = static_cast<std::uint32_t>(r.y1 - r.y0);
  if ((width | height) <= 1) {
    body(first, 1u);
    body(first + 1, width);
    body(first + row, height);
    body(first + row + 1, width & height);
    return;
  }
  for (std::size_t y = 0; y <= height; ++y) {
    for (std::size_t x = 0; x <= width; ++x) body(first + y * row + x, 1u);
  }
}

}  // namespace

void TileLists::build(std::span<const std::uint32_t> visible, const std::uint32_t* keys,
                      const TileRect* rects, int tiles_x, int tiles_y, ThreadPool& pool) {
  sort(visible, keys, rects);
  deal(tiles_x, tiles_x * tiles_y, pool);
}

/// Radix sort in two passes of 11 bits, the first of which reads the chunks where they lie.
void TileLists::sort(std::span<const std::uint32_t> visible, const std::uint32_t* keys,
                     const TileRect* rects) {
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
  sorted_rects_.ensure(total_);
  for (std::size_t c = 0; c < visible.size(); ++c) {
    const auto first = static_cast<std::uint32_t>(c * kChunk);
    for (std::uint32_t i = first; i < first + visible[c]; ++i) {
      const std::uint32_t to = low[keys[i] & kDigitMask]++;
      half_keys_[to] = keys[i] >> kDigitBits;
      half_ids_[to] = i;
    }
  }
  for (std::uint32_t i = 0; i < total_; ++i) {
    const std::uint32_t to = high[half_keys_[i]]++, id = half_ids_[i];
    sorted_[to] = id;
    sorted_rects_[to] = rects[id];
  }
}

/// Counting sort by tile. Each part of the sorted order counts and deals on its own; as the parts
/// follow one another within each tile, the outcome does not depend on their number.
void TileLists::deal(int tiles_x, int tiles, ThreadPool& pool) {
  const int parts = pool.threads();
  const auto n = static_cast<std::size_t>(tiles);
  // for_each_tile may name tiles beyond the last one.
  const std::size_t cells = n + static_cast<std::size_t>(tiles_x) + 2;
  cursors_.resize(static_cast<std::size_t>(parts));
  const auto begin_of = [&](int part) {
    return static_cast<std::size_t>(total_) * static_cast<std::size_t>(part) /
           static_cast<std::size_t>(parts);
  };
  pool.run(parts, [&](int part, int) {
    auto& counts = cursors_[static_cast<std::size_t>(part)];
    counts.assign(cells, 0);
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
      for_each_tile(sorted_rects_[i], tiles_x,
                    [&](std::size_t t, std::uint32_t count) { counts[t] += count; });
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
  // What does not count is written behind the last entry, each part's apart from the others'.
  constexpr std::uint32_t kApart = 16;
  entries_.ensure(sum + kApart * static_cast<std::uint32_t>(parts));
  pool.run(parts, [&](int part, int) {
    std::uint32_t* cursor = cursors_[static_cast<std::size_t>(part)].data();
    const std::uint32_t discarded = sum + kApart * static_cast<std::uint32_t>(part);
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
      const std::uint32_t id = sorted_[i];
      for_each_tile(sorted_rects_[i], tiles_x, [&](std::size_t t, std::uint32_t count) {
        const std::uint32_t at = cursor[t], counts = 0u - count;
        entries_[(at & counts) | (discarded & ~counts)] = id;
        cursor[t] = at + count;
      });
    }
  });
}

}  // namespace sgs::render::cpu
