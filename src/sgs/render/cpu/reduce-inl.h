// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Horizontal sums of ten vectors at once, by a tree of shuffles and additions: each step halves
// the number of vectors and the number of partial sums per quantity.

#if defined(SGS_RENDER_CPU_REDUCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SGS_RENDER_CPU_REDUCE_INL_H_
#undef SGS_RENDER_CPU_REDUCE_INL_H_
#else
#define SGS_RENDER_CPU_REDUCE_INL_H_
#endif

#include "sgs/render/cpu/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

/// Lane of a SumRow that holds the i-th sum.
inline constexpr int kSumLane16[10] = {0, 8, 4, 12, 1, 9, 5, 13, 2, 10};
constexpr int sum_lane(int i) { return kLanes == 16 ? kSumLane16[i] : i; }

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void store_ten_sums(const F* v, float* row) {
  for (int i = 0; i < 10; ++i) store(v[i], row + i);
  for (int i = 10; i < 16; ++i) row[i] = 0;
}

#else

/// Per 128-bit block: a0+a2 b0+b2 a1+a3 b1+b3.
HWY_INLINE VF fold_lanes(VF a, VF b) {
  return hn::Add(hn::InterleaveLower(kF, a, b), hn::InterleaveUpper(kF, a, b));
}

/// Per 128-bit block the full sums of what went into two fold_lanes.
HWY_INLINE VF fold_pairs(VF a, VF b) {
  const hn::Repartition<double, FloatTag> d64;
  const auto x = hn::BitCast(d64, a), y = hn::BitCast(d64, b);
  return hn::Add(hn::BitCast(kF, hn::InterleaveLower(d64, x, y)),
                 hn::BitCast(kF, hn::InterleaveUpper(d64, x, y)));
}

#if HWY_MAX_BYTES > 16
/// Block pairs: a0+a1 b0+b1 (a2+a3 b2+b3).
HWY_INLINE VF fold_blocks(VF a, VF b) {
  return hn::Add(hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b), a),
                 hn::OddEvenBlocks(b, hn::SwapAdjacentBlocks(a)));
}
/// Lower half: the halves of a added; upper half: those of b.
HWY_INLINE VF fold_halves(VF a, VF b) {
  return hn::Add(hn::ConcatLowerLower(kF, b, a), hn::ConcatUpperUpper(kF, b, a));
}
#endif

/// Writes the ten sums over lanes of `v` to row[sum_lane(i)].
HWY_INLINE void store_ten_sums(const F* v, float* row) {
  const VF zero = hn::Zero(kF);
#if HWY_MAX_BYTES == 16
  const VF c0 = fold_lanes(v[0].v, v[1].v), c1 = fold_lanes(v[2].v, v[3].v);
  const VF c2 = fold_lanes(v[4].v, v[5].v), c3 = fold_lanes(v[6].v, v[7].v);
  const VF c4 = fold_lanes(v[8].v, v[9].v);
  hn::Store(fold_pairs(c0, c1), kF, row);
  hn::Store(fold_pairs(c2, c3), kF, row + 4);
  hn::Store(fold_pairs(c4, zero), kF, row + 8);
  hn::Store(zero, kF, row + 12);
#else
  if constexpr (kLanes == 8) {
    const VF b0 = fold_blocks(v[0].v, v[4].v), b1 = fold_blocks(v[1].v, v[5].v);
    const VF b2 = fold_blocks(v[2].v, v[6].v), b3 = fold_blocks(v[3].v, v[7].v);
    const VF b4 = fold_blocks(v[8].v, zero), b5 = fold_blocks(v[9].v, zero);
    hn::Store(fold_pairs(fold_lanes(b0, b1), fold_lanes(b2, b3)), kF, row);
    hn::Store(fold_pairs(fold_lanes(b4, b5), zero), kF, row + 8);
  } else {
    const VF a0 = fold_halves(v[0].v, v[1].v), a1 = fold_halves(v[2].v, v[3].v);
    const VF a2 = fold_halves(v[4].v, v[5].v), a3 = fold_halves(v[6].v, v[7].v);
    const VF a4 = fold_halves(v[8].v, v[9].v);
    const VF b0 = fold_blocks(a0, a1), b1 = fold_blocks(a2, a3), b2 = fold_blocks(a4, zero);
    hn::Store(fold_pairs(fold_lanes(b0, b1), fold_lanes(b2, zero)), kF, row);
  }
#endif
}

#endif  // HWY_SCALAR

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
