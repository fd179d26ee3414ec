// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/tile.h"

#include <cstring>

#include "sgs/render/cpu/targets.h"

namespace sgs::render::cpu {

// Called from code compiled for one instruction set, defined once in portable code.
void grow_alphas(TileScratch& scratch, std::size_t size, std::size_t keep);

}  // namespace sgs::render::cpu

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/render/cpu/tile.cc"
#include <hwy/foreach_target.h>

#include "sgs/render/cpu/tile_backward-inl.h"
#include "sgs/render/cpu/tile_forward-inl.h"
#include "sgs/render/cpu/tile_loss-inl.h"
#include "sgs/render/cpu/tile_stage-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

struct TilePlace {
  int x0, y0, width, height;  // first pixel; image size
};

HWY_INLINE Mask inside_image(const TilePlace& t, int block, int part) {
  const F w(static_cast<float>(t.width - t.x0)), h(static_cast<float>(t.height - t.y0));
  return hn::And(block_x(block, part) < w, block_y(block, part) < h);
}

/// Clears the blocks' states; returns the mask of the blocks that lie in the image.
HWY_INLINE std::uint64_t start_blocks(const TilePlace& t, BlockState* states) {
  std::uint64_t live = 0;
  const F zero(0.0f);
  for (int b = 0; b < kBlocksPerTile; ++b) {
    for (int part = 0; part < kParts; ++part) {
      const int at = part * kLanes;
      BlockState& s = states[b];
      const Mask inside = inside_image(t, b, part);
      if (!hn::AllFalse(kF, inside)) live |= std::uint64_t{1} << b;
      store(zero_unless(inside, F(1.0f)), s.T + at);
      for (float* channel : {s.r, s.g, s.b, s.d, s.a}) store(zero, channel + at);
    }
  }
  return live;
}

/// Turns the per-Gaussian block masks of a batch into per-block lists of (Gaussian, alpha) words.
/// Returns the number of alphas.
HWY_INLINE std::uint32_t list_by_block(std::uint32_t begin, std::uint32_t end, std::uint64_t live,
                                       std::uint32_t first_alpha, TileScratch& scratch,
                                       std::uint32_t* counts) {
  std::memset(counts, 0, kBlocksPerTile * sizeof *counts);
  std::uint64_t* blocks = scratch.blocks.data();
  std::uint64_t* active = scratch.active.data();
  std::uint32_t* starts = scratch.alpha_start.data();
  std::uint32_t* words = scratch.block_entries.data();
  std::uint32_t alpha = 0;
  for (std::uint32_t j = begin; j < end; ++j) {
    std::uint64_t m = blocks[j] & live;
    blocks[j] = active[j] = m;
    starts[j] = first_alpha + alpha;
    while (m != 0) {
      const int b = __builtin_ctzll(m);
      m &= m - 1;
      words[static_cast<std::uint32_t>(b) * kListStride + counts[b]++] =
          (j - begin) << 16 | alpha++;
    }
  }
  return alpha;
}

/// Composites the whole tile. Returns how many Gaussians were visited.
HWY_INLINE std::uint32_t forward_tile(const TileJob& job, const std::uint32_t* entries,
                                      std::uint32_t count, const TilePlace& place,
                                      TileScratch& scratch) {
  std::uint64_t live = start_blocks(place, scratch.state);
  std::uint32_t alphas = 0, begin = 0;
  while (begin < count && live != 0) {
    const std::uint32_t end = count - begin < kBatch ? count : begin + kBatch;
    stage_batch(job, entries, begin, end, count, scratch);
    std::uint32_t counts[kBlocksPerTile];
    const std::uint32_t added = list_by_block(begin, end, live, alphas, scratch, counts);
    const std::size_t needed = static_cast<std::size_t>(alphas + added) * kBlockPixels;
    if (needed > scratch.alphas.capacity()) {
      grow_alphas(scratch, needed, static_cast<std::size_t>(alphas) * kBlockPixels);
    }
    float* own_alphas = scratch.alphas.data() + static_cast<std::size_t>(alphas) * kBlockPixels;
    for (int b = 0; b < kBlocksPerTile; ++b) {
      if (counts[b] == 0) continue;
      const std::uint32_t* words = scratch.block_entries.data() + b * kListStride;
      const std::uint32_t visited = composite_block(scratch.staged.data() + begin, words, counts[b],
                                                    b, own_alphas, scratch.state[b]);
      if (visited == counts[b]) continue;
      const std::uint64_t others = ~(std::uint64_t{1} << b);
      live &= others;
      std::uint64_t* active = scratch.active.data() + begin;
      for (std::uint32_t e = visited; e < counts[b]; ++e) active[words[e] >> 16] &= others;
    }
    alphas += added;
    begin = end;
  }
  return begin;
}

HWY_INLINE void store_image(const BlockState* states, float* image) {
  for (int b = 0; b < kBlocksPerTile; ++b) {
    const BlockState& s = states[b];
    for (const float* channel : {s.r, s.g, s.b, s.d, s.a}) {
      for (int part = 0; part < kParts; ++part) {
        store(load(channel + part * kLanes), image + part * kLanes);
      }
      image += kBlockPixels;
    }
  }
}

HWY_INLINE double lane_sum(F v) {
  alignas(64) float lanes[16];
  store(v, lanes);
  double sum = 0;
  for (int l = 0; l < kLanes; ++l) sum += static_cast<double>(lanes[l]);
  return sum;
}

HWY_INLINE void loss_tile(const TileJob& job, const TilePlace& place, TileScratch& scratch) {
  LossSums sums;
  sums.loss = F(0.0f);
  for (int c = 0; c < 3; ++c) sums.measured[c] = sums.rendered[c] = F(0.0f);
  for (int b = 0; b < kBlocksPerTile; ++b) {
    const float* extra = job.color_gradient == nullptr
                             ? nullptr
                             : job.color_gradient + b * kGradientChannels * kBlockPixels;
    for (int part = 0; part < kParts; ++part) {
      loss_part(job.loss, scratch.state[b], job.target + b * kTargetChannels * kBlockPixels, extra,
                inside_image(place, b, part), part, scratch.gradient[b], sums);
    }
  }
  job.result->loss = lane_sum(sums.loss);
  for (int c = 0; c < 3; ++c) {
    job.result->exposure_measured[c] = lane_sum(sums.measured[c]);
    job.result->exposure_rendered[c] = lane_sum(sums.rendered[c]);
  }
}

void ProcessTile(const TileJob& job, const std::uint32_t* entries, std::uint32_t count,
                 TileScratch& scratch) {
  const TilePlace place = {job.tile_x * kTileSide, job.tile_y * kTileSide, job.width, job.height};
  const std::uint32_t visited = forward_tile(job, entries, count, place, scratch);
  if (job.image != nullptr) store_image(scratch.state, job.image);
  if (job.target == nullptr) return;
  loss_tile(job, place, scratch);
  if (job.loss.floater_margin_m > 0) {
    backward_tile<true>(job, visited, scratch);
  } else {
    backward_tile<false>(job, visited, scratch);
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::render::cpu {
HWY_EXPORT(ProcessTile);

void grow_alphas(TileScratch& scratch, std::size_t size, std::size_t keep) {
  scratch.alphas.ensure(size, keep);
}

void process_tile(const TileJob& job, TileScratch& scratch) {
  constexpr std::size_t kMaxLanes = 16;
  const std::size_t count = job.entries.size();
  scratch.staged.ensure(count);
  scratch.blocks.ensure(count + kMaxLanes);
  scratch.active.ensure(count);
  scratch.alpha_start.ensure(count);
  scratch.slots.ensure(count);
  scratch.block_entries.ensure(std::size_t{kBlocksPerTile} * kListStride);
  HWY_DYNAMIC_DISPATCH(ProcessTile)
  (job, job.entries.data(), static_cast<std::uint32_t>(count), scratch);
}
}  // namespace sgs::render::cpu
#endif
