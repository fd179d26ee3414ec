// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Front-to-back compositing of a batch of Gaussians, block by block: a block's state stays in
// registers while its Gaussians pass by. Their alphas are kept for the backward pass.

#if defined(SGS_RENDER_CPU_TILE_FORWARD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SGS_RENDER_CPU_TILE_FORWARD_INL_H_
#undef SGS_RENDER_CPU_TILE_FORWARD_INL_H_
#else
#define SGS_RENDER_CPU_TILE_FORWARD_INL_H_
#endif

#include "sgs/render/cpu/lanes-inl.h"
#include "sgs/render/cpu/tile.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

/// Column or row within the tile of the 16 pixels of a block in block column or row 0..7.
struct BlockOffsets {
  alignas(64) float of[kTileBlocks][kBlockPixels];
};
constexpr BlockOffsets make_offsets(int divisor) {
  BlockOffsets o{};
  for (int i = 0; i < kTileBlocks; ++i) {
    for (int l = 0; l < kBlockPixels; ++l) {
      o.of[i][l] = static_cast<float>(i * kBlockSide + l / divisor % kBlockSide);
    }
  }
  return o;
}
inline constexpr BlockOffsets kPixelX = make_offsets(1), kPixelY = make_offsets(kBlockSide);

HWY_INLINE F block_x(int block, int part) {
  return load(kPixelX.of[block % kTileBlocks] + part * kLanes);
}
HWY_INLINE F block_y(int block, int part) {
  return load(kPixelY.of[block / kTileBlocks] + part * kLanes);
}

struct PixelState {
  F T, r, g, b, d, a;
};

/// One Gaussian over kLanes pixels. T goes on shrinking below the limit unseen, so that the only
/// chain from step to step is one multiply-add; its dead lanes are masked out of the weights.
HWY_INLINE void composite_step(const Staged& q, F x, F y, F limit, PixelState& s,
                               float* alpha_out) {
  const F dx = x + F(q.x), dy = y + F(q.y);
  const F power =
      mul_add(mul_add(F(q.A), dx, F(q.B) * dy), dx, mul_add(F(q.C) * dy, dy, F(q.log2_opacity)));
  const F alpha = zero_unless(power >= F(-kLog2Of255), minimum(exp2_of(power), F(kMaxAlpha)));
  const F seen = zero_unless(s.T > limit, alpha);
  const F weight = seen * s.T;
  s.T = neg_mul_add(alpha, s.T, s.T);
  s.r = mul_add(weight, F(q.r), s.r);
  s.g = mul_add(weight, F(q.g), s.g);
  s.b = mul_add(weight, F(q.b), s.b);
  s.d = mul_add(weight, F(q.z), s.d);
  s.a = s.a + weight;
  store(seen, alpha_out);
}

/// Composites the `count` Gaussians of `list` over one part of a block and stores their alphas in
/// its order; returns how many were visited before all its pixels were saturated.
HWY_INLINE std::uint32_t composite_part(const Staged* staged, const std::uint32_t* list,
                                        std::uint32_t count, int block, int part, F limit,
                                        float* alphas, BlockState& state) {
  const int at = part * kLanes;
  PixelState s = {load(state.T + at), load(state.r + at), load(state.g + at),
                  load(state.b + at), load(state.d + at), load(state.a + at)};
  const F x = block_x(block, part), y = block_y(block, part);
  std::uint32_t e = 0;
  const auto step = [&](std::uint32_t i) HWY_ATTR {
    composite_step(staged[list[i]], x, y, limit, s, alphas + i * kBlockPixels + at);
  };
  while (e + 4 <= count) {
    step(e);
    step(e + 1);
    step(e + 2);
    step(e + 3);
    e += 4;
    const Mask alive = s.T > limit;
    s.T = zero_unless(alive, s.T);  // and never denormal
    if (hn::AllFalse(kF, alive)) break;
  }
  if (e + 4 > count && hn::AllFalse(kF, s.T > F(0.0f)) == false) {
    for (; e < count; ++e) step(e);
    s.T = zero_unless(s.T > limit, s.T);
  }
  store(s.T, state.T + at);
  store(s.r, state.r + at);
  store(s.g, state.g + at);
  store(s.b, state.b + at);
  store(s.d, state.d + at);
  store(s.a, state.a + at);
  return e;
}

/// Whole block; alphas of parts that stopped earlier than others are filled with zeros.
HWY_INLINE std::uint32_t composite_block(const Staged* staged, const std::uint32_t* list,
                                         std::uint32_t count, int block, F limit, float* alphas,
                                         BlockState& state) {
  std::uint32_t visited[kParts], most = 0;
  for (int part = 0; part < kParts; ++part) {
    visited[part] = composite_part(staged, list, count, block, part, limit, alphas, state);
    if (visited[part] > most) most = visited[part];
  }
  if constexpr (kParts > 1) {
    for (int part = 0; part < kParts; ++part) {
      for (std::uint32_t e = visited[part]; e < most; ++e) {
        store(F(0.0f), alphas + e * kBlockPixels + part * kLanes);
      }
    }
  }
  return most;
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
