// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/tile.h"

#include <cstring>

#include "sgs/core/simd_targets.h"

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

/// Asks for a block of the training view early; it is read after the whole tile has been
/// composited.
HWY_INLINE void prefetch_training(const TileJob& job, int block) {
  if (job.training == nullptr) return;
  const float* training = job.training + block * kTrainingChannels * kBlockPixels;
  for (int c = 0; c < kTrainingChannels; ++c) __builtin_prefetch(training + c * kBlockPixels, 0, 2);
}

/// Composites the whole tile. Returns how many Gaussians were visited.
HWY_INLINE std::uint32_t forward_tile(const TileJob& job, const std::uint32_t* entries,
                                      std::uint32_t count, const TilePlace& place,
                                      TileScratch& scratch) {
  std::uint64_t live = start_blocks(place, scratch.state);
  const F limit(job.min_transmittance);
  std::uint32_t alphas = 0, begin = 0;
  while (begin < count && live != 0) {
    const std::uint32_t end = count - begin < kBatch ? count : begin + kBatch;
    std::uint32_t counts[kBlocksPerTile];
    stage_batch(job, entries, begin, end, count, live, scratch, counts);
    std::uint32_t* alpha_start = scratch.alpha_start.data() + begin / kBatch * kBlocksPerTile;
    const std::uint32_t first_alpha = alphas;
    for (int b = 0; b < kBlocksPerTile; ++b) {
      alpha_start[b] = alphas;
      alphas += counts[b];
    }
    const std::size_t needed = static_cast<std::size_t>(alphas) * kBlockPixels;
    if (needed > scratch.alphas.capacity()) {
      grow_alphas(scratch, needed, static_cast<std::size_t>(first_alpha) * kBlockPixels);
    }
    for (int b = 0; b < kBlocksPerTile; ++b) {
      if (begin == 0) prefetch_training(job, b);
      if (counts[b] == 0) continue;
      const std::uint32_t* list = scratch.block_list.data() + b * kListStride;
      float* own = scratch.alphas.data() + static_cast<std::size_t>(alpha_start[b]) * kBlockPixels;
      const std::uint32_t visited = composite_block(scratch.staged.data() + begin, list, counts[b],
                                                    b, limit, own, scratch.state[b]);
      if (visited == counts[b]) continue;
      live &= ~(std::uint64_t{1} << b);
      std::uint32_t* active = scratch.active[b / 32].data() + begin;
      const std::uint32_t others = ~(1u << b % 32);
      for (std::uint32_t e = visited; e < counts[b]; ++e) active[list[e]] &= others;
    }
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
      loss_part(job.loss, scratch.state[b], job.training + b * kTrainingChannels * kBlockPixels,
                extra, inside_image(place, b, part), part, scratch.gradient[b], sums);
    }
  }
  job.result->loss = lane_sum(sums.loss);
  for (int c = 0; c < 3; ++c) {
    job.result->exposure_measured[c] = lane_sum(sums.measured[c]);
    job.result->exposure_rendered[c] = lane_sum(sums.rendered[c]);
  }
}

template <bool kFloaters>
HWY_INLINE void backward(const TileJob& job, std::uint32_t visited, TileScratch& scratch) {
  if (job.note_reached) {
    backward_tile<kFloaters, true>(job, visited, scratch);
  } else {
    backward_tile<kFloaters, false>(job, visited, scratch);
  }
}

void ProcessTile(const TileJob& job, const std::uint32_t* entries, std::uint32_t count,
                 TileScratch& scratch) {
  const TilePlace place = {job.tile_x * kTileSide, job.tile_y * kTileSide, job.width, job.height};
  const std::uint32_t visited = forward_tile(job, entries, count, place, scratch);
  if (job.image != nullptr) store_image(scratch.state, job.image);
  if (job.training == nullptr) return;
  loss_tile(job, place, scratch);
  if (job.loss.floater_margin_m > 0) {
    backward<true>(job, visited, scratch);
  } else {
    backward<false>(job, visited, scratch);
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
  for (auto& active : scratch.active) active.ensure(count + kMaxLanes);
  scratch.alpha_start.ensure((count / kBatch + 1) * kBlocksPerTile);
  scratch.slots.ensure(count);
  scratch.block_list.ensure(std::size_t{kBlocksPerTile} * kListStride);
  HWY_DYNAMIC_DISPATCH(ProcessTile)
  (job, job.entries.data(), static_cast<std::uint32_t>(count), scratch);
}
}  // namespace sgs::render::cpu
#endif
