// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Front-to-back backward pass over a tile, Gaussian by Gaussian, with the alphas of the forward
// pass. What lies behind a Gaussian is the final value minus what has been passed so far:
//   value_i = g . (r g b z 1),  S_i = sum_{j >= i} w_j value_j,
//   dL/dalpha_i = T_i value_i - S_{i+1} / (1 - alpha_i).

#if defined(SGS_RENDER_CPU_TILE_BACKWARD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SGS_RENDER_CPU_TILE_BACKWARD_INL_H_
#undef SGS_RENDER_CPU_TILE_BACKWARD_INL_H_
#else
#define SGS_RENDER_CPU_TILE_BACKWARD_INL_H_
#endif

#include <cstring>

#include "sgs/render/cpu/reduce-inl.h"
#include "sgs/render/cpu/tile_forward-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

/// 1 / a for a in [0.01, 1] to a relative error of 6e-5 or better.
HWY_INLINE F reciprocal(F a) {
  const F guess = hn::ApproximateReciprocal(a.v);
  if constexpr (kLanes == 16) return guess;  // 14 bits; elsewhere 12 or fewer
  const F better = guess * neg_mul_add(a, guess, F(2.0f));
#if HWY_NATIVE_FMA
  return better;
#else
  // The product above was rounded before it was subtracted.
  return better * neg_mul_add(a, better, F(2.0f));
#endif
}

/// Adds one block's share to the ten sums h, hx, hy, hxx, hxy, hyy, r, g, b, z. Returns the
/// Gaussian's weights.
template <bool kFloaters>
HWY_INLINE F backward_step(const Staged& q, const float* alphas, int block, int part,
                           BlockGradient& g, F* sums) {
  const int at = part * kLanes;
  const F alpha = load(alphas + at), T = load(g.T + at);
  const F gr = load(g.r + at), gg = load(g.g + at), gb = load(g.b + at), gd = load(g.d + at);
  const F value = mul_add(
      gr, F(q.r), mul_add(gg, F(q.g), mul_add(gb, F(q.b), mul_add(gd, F(q.z), load(g.a + at)))));
  const F seen = alpha * T;
  F weight = seen;
  const F behind = neg_mul_add(weight, value, load(g.S + at));
  store(behind, g.S + at);
  store(T - weight, g.T + at);
  const F d_alpha = neg_mul_add(behind, reciprocal(F(1.0f) - alpha), T * value);
  F h = zero_unless(alpha < F(kMaxAlpha), alpha * d_alpha);
  if constexpr (kFloaters) {
    const Mask counts = F(q.z) >= load(g.nearest_z + at);
    h = zero_unless(counts, h);
    weight = zero_unless(counts, weight);
  }
  const F dx = block_x(block, part) + F(q.x), dy = block_y(block, part) + F(q.y);
  const F hx = h * dx, hy = h * dy;
  sums[0] = sums[0] + h;
  sums[1] = sums[1] + hx;
  sums[2] = sums[2] + hy;
  sums[3] = mul_add(hx, dx, sums[3]);
  sums[4] = mul_add(hx, dy, sums[4]);
  sums[5] = mul_add(hy, dy, sums[5]);
  sums[6] = mul_add(weight, gr, sums[6]);
  sums[7] = mul_add(weight, gg, sums[7]);
  sums[8] = mul_add(weight, gb, sums[8]);
  sums[9] = mul_add(weight, gd, sums[9]);
  return seen;
}

/// Backward pass of the Gaussians [begin, end) of one batch whose alphas start at `alpha_start` in
/// each block: writes their slots and marks those used, with `kNoteReached` also those in which the
/// Gaussian weighs enough.
template <bool kFloaters, bool kNoteReached>
HWY_INLINE void backward_batch(const TileJob& job, std::uint32_t begin, std::uint32_t end,
                               const std::uint32_t* alpha_start, TileScratch& scratch) {
  constexpr std::uint32_t kAhead = 6;
  const Staged* staged = scratch.staged.data();
  const std::uint32_t* low = scratch.active[0].data();
  const std::uint32_t* high = scratch.active[1].data();
  const std::uint32_t* slots = scratch.slots.data();
  const float* alphas = scratch.alphas.data();
  // Gaussians come in the order of the blocks' lists, so each block reads its alphas one by one.
  std::uint32_t next[kBlocksPerTile];
  std::memcpy(next, alpha_start, sizeof next);
  for (std::uint32_t j = begin; j < end; ++j) {
    if (j + kAhead < end) __builtin_prefetch(&job.slots[slots[j + kAhead]], 1);
    std::uint64_t active = low[j] | static_cast<std::uint64_t>(high[j]) << (kBlocksPerTile / 2);
    if (active == 0) continue;
    const std::uint32_t slot = slots[j];
    F sums[10], strongest(0.0f);
    for (F& s : sums) s = F(0.0f);
    do {
      const int block = __builtin_ctzll(active);
      active &= active - 1;
      const float* own = alphas + static_cast<std::size_t>(next[block]++) * kBlockPixels;
      for (int part = 0; part < kParts; ++part) {
        const F weight =
            backward_step<kFloaters>(staged[j], own, block, part, scratch.gradient[block], sums);
        if constexpr (kNoteReached) strongest = maximum(strongest, weight);
      }
    } while (active != 0);
    job.slot_used[slot] = kSlotUsed;
    if constexpr (kNoteReached) {
      if (!hn::AllFalse(kF, strongest >= F(job.reached_weight))) {
        job.slot_used[slot] = kSlotReached;
      }
    }
    store_ten_sums(sums, job.slots[slot].lane);
  }
}

/// Backward pass of the first `visited` Gaussians of a tile.
template <bool kFloaters, bool kNoteReached>
HWY_INLINE void backward_tile(const TileJob& job, std::uint32_t visited, TileScratch& scratch) {
  for (std::uint32_t begin = 0; begin < visited; begin += kBatch) {
    const std::uint32_t end = visited - begin < kBatch ? visited : begin + kBatch;
    backward_batch<kFloaters, kNoteReached>(
        job, begin, end, scratch.alpha_start.data() + begin / kBatch * kBlocksPerTile, scratch);
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
