// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/render/cpu/buffer.h"
#include "sgs/render/cpu/layout.h"

namespace sgs::render::cpu {

/// Visible Gaussians of each tile, nearest first.
class TileLists {
 public:
  /// Sorts the records of all chunks by key (stably, so that ties stay in index order) and deals
  /// them out to the tiles of a `tiles_x` x `tiles_y` grid. `visible[c]` is the number of records
  /// of chunk c; keys and rects are indexed like records.
  void build(std::span<const std::uint32_t> visible, const std::uint32_t* keys,
             const TileRect* rects, int tiles_x, int tiles_y, ThreadPool& pool);

  /// Record indices of tile `t` (row-major).
  std::span<const std::uint32_t> tile(int t) const {
    const auto i = static_cast<std::size_t>(t);
    return {entries_.data() + start_[i], start_[i + 1] - start_[i]};
  }

 private:
  void sort(std::span<const std::uint32_t> visible, const std::uint32_t* keys,
            const TileRect* rects, ThreadPool& pool);
  void deal(int tiles_x, int tiles, ThreadPool& pool);

  std::uint32_t total_ = 0;
  Buffer<std::uint32_t> half_keys_, half_ids_, sorted_;
  Buffer<TileRect> sorted_rects_;
  Buffer<std::uint32_t> entries_;
  std::vector<std::uint32_t> start_;
  std::vector<std::vector<std::uint32_t>> cursors_;  // per part of the input, per digit or tile
};

}  // namespace sgs::render::cpu
