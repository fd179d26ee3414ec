// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/sort_bin.h"

#include <algorithm>

namespace sgs::render::cpu {
namespace {

constexpr std::uint32_t kDigitBits = 11, kDigits = 1u << kDigitBits, kDigitMask = kDigits - 1;

/// One pass of a radix sort. Each part of the input counts its digits and then moves its elements
/// on its own; as the parts follow one another within each digit, the outcome does not depend on
/// their number. Calls count(part, counts) and move(part, cursors) for each part.
template <class Count, class Move>
void radix_pass(std::vector<std::vector<std::uint32_t>>& cursors, ThreadPool& pool,
                const Count& count, const Move& move) {
  pool.run(static_cast<int>(cursors.size()), [&](int part, int) {
    auto& counts = cursors[static_cast<std::size_t>(part)];
    counts.assign(kDigits, 0);
    count(part, counts.data());
  });
  std::uint32_t sum = 0;
  for (std::size_t digit = 0; digit < kDigits; ++digit) {
    for (auto& counts : cursors) {
      const std::uint32_t n = counts[digit];
      counts[digit] = sum;
      sum += n;
    }
  }
  pool.run(static_cast<int>(cursors.size()),
           [&](int part, int) { move(part, cursors[static_cast<std::size_t>(part)].data()); });
}

/// First element of part `part` of `parts` of `count` elements.
std::size_t part_begin(std::size_t count, int part, int parts) {
  return count * static_cast<std::size_t>(part) / static_cast<std::size_t>(parts);
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
  sort(visible, keys, rects, pool);
  deal(tiles_x, tiles_x * tiles_y, pool);
}

/// Radix sort in two passes of 11 bits, the first of which reads the chunks where they lie.
void TileLists::sort(std::span<const std::uint32_t> visible, const std::uint32_t* keys,
                     const TileRect* rects, ThreadPool& pool) {
  total_ = 0;
  for (const std::uint32_t count : visible) total_ += count;
  half_keys_.ensure(total_);
  half_ids_.ensure(total_);
  sorted_.ensure(total_);
  sorted_rects_.ensure(total_);
  const int parts = pool.threads();
  cursors_.resize(static_cast<std::size_t>(parts));
  const auto for_each_record = [&](int part, const auto& body) {
    const std::size_t end = part_begin(visible.size(), part + 1, parts);
    for (std::size_t c = part_begin(visible.size(), part, parts); c < end; ++c) {
      const auto first = static_cast<std::uint32_t>(c * kChunk);
      for (std::uint32_t i = first; i < first + visible[c]; ++i) body(i);
    }
  };
  radix_pass(
      cursors_, pool,
      [&](int part, std::uint32_t* counts) {
        for_each_record(part, [&](std::uint32_t i) { ++counts[keys[i] & kDigitMask]; });
      },
      [&](int part, std::uint32_t* cursors) {
        for_each_record(part, [&](std::uint32_t i) {
          const std::uint32_t to = cursors[keys[i] & kDigitMask]++;
          half_keys_[to] = keys[i] >> kDigitBits;
          half_ids_[to] = i;
        });
      });
  const auto begin_of = [&](int part) { return part_begin(total_, part, parts); };
  radix_pass(
      cursors_, pool,
      [&](int part, std::uint32_t* counts) {
        for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) ++counts[half_keys_[i]];
      },
      [&](int part, std::uint32_t* cursors) {
        for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
          const std::uint32_t to = cursors[half_keys_[i]]++, id = half_ids_[i];
          sorted_[to] = id;
          sorted_rects_[to] = rects[id];
        }
      });
}

/// Counting sort by tile. Each part of the sorted order counts and deals on its own; as the parts
/// follow one another within each tile, the outcome does not depend on their number.
void TileLists::deal(int tiles_x, int tiles, ThreadPool& pool) {
  const int parts = pool.threads();
  const auto n = static_cast<std::size_t>(tiles);
  // for_each_tile may name tiles beyond the last one.
  const std::size_t cells = n + static_cast<std::size_t>(tiles_x) + 2;
  cursors_.resize(static_cast<std::size_t>(parts));
  const auto begin_of = [&](int part) { return part_begin(total_, part, parts); };
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
