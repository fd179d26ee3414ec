// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Vectors of up to 16 floats with arithmetic operators, for the instruction set being compiled.
// Only for translation units built through hwy/foreach_target.h.

#if defined(SGS_RENDER_CPU_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SGS_RENDER_CPU_LANES_INL_H_
#undef SGS_RENDER_CPU_LANES_INL_H_
#else
#define SGS_RENDER_CPU_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

#include "sgs/render/view.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<FloatTag>;
inline constexpr FloatTag kF;
inline constexpr IntTag kI;
using VF = hn::Vec<FloatTag>;
using VI = hn::Vec<IntTag>;
using Mask = hn::Mask<FloatTag>;
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(FloatTag()));
/// Vectors that make up a block of 16 pixels.
inline constexpr int kParts = 16 / kLanes;

struct F {
  VF v;
  F() = default;
  HWY_INLINE F(VF vec) : v(vec) {}  // NOLINT(google-explicit-constructor)
  HWY_INLINE explicit F(float s) : v(hn::Set(kF, s)) {}
};
HWY_INLINE F operator+(F a, F b) { return hn::Add(a.v, b.v); }
HWY_INLINE F operator-(F a, F b) { return hn::Sub(a.v, b.v); }
HWY_INLINE F operator*(F a, F b) { return hn::Mul(a.v, b.v); }
HWY_INLINE F operator/(F a, F b) { return hn::Div(a.v, b.v); }
HWY_INLINE Mask operator<(F a, F b) { return hn::Lt(a.v, b.v); }
HWY_INLINE Mask operator>(F a, F b) { return hn::Gt(a.v, b.v); }
HWY_INLINE Mask operator<=(F a, F b) { return hn::Le(a.v, b.v); }
HWY_INLINE Mask operator>=(F a, F b) { return hn::Ge(a.v, b.v); }
HWY_INLINE F mul_add(F a, F b, F c) { return hn::MulAdd(a.v, b.v, c.v); }
HWY_INLINE F neg_mul_add(F a, F b, F c) { return hn::NegMulAdd(a.v, b.v, c.v); }
HWY_INLINE F square_root(F a) { return hn::Sqrt(a.v); }
HWY_INLINE F minimum(F a, F b) { return hn::Min(a.v, b.v); }
HWY_INLINE F maximum(F a, F b) { return hn::Max(a.v, b.v); }
HWY_INLINE F absolute(F a) { return hn::Abs(a.v); }
HWY_INLINE F select(Mask m, F yes, F no) { return hn::IfThenElse(m, yes.v, no.v); }
HWY_INLINE F zero_unless(Mask m, F a) { return hn::IfThenElseZero(m, a.v); }
HWY_INLINE F one_where_equal(F a, F b) {
  return hn::IfThenElseZero(hn::Eq(a.v, b.v), hn::Set(kF, 1.0f));
}
HWY_INLINE F load(const float* p) { return hn::LoadU(kF, p); }
HWY_INLINE void store(F a, float* p) { hn::StoreU(a.v, kF, p); }

/// 2^a to a relative error of 3.5e-6 for |a| < 126 (polynomial on [-1/2, 1/2]).
HWY_INLINE F exp2_of(F a) {
  const VF magic = hn::Set(kF, 12582912.0f);  // 1.5 * 2^23: adding it rounds to an integer
  const VF shifted = hn::Add(a.v, magic);
  const VF f = hn::Sub(a.v, hn::Sub(shifted, magic));
  VF r = hn::MulAdd(hn::Set(kF, 0.00966636852f), f, hn::Set(kF, 0.0559219758f));
  r = hn::MulAdd(r, f, hn::Set(kF, 0.24022349f));
  r = hn::MulAdd(r, f, hn::Set(kF, 0.693121045f));
  r = hn::MulAdd(r, f, hn::Set(kF, 1.0f));
  return hn::BitCast(kF, hn::Add(hn::BitCast(kI, r), hn::ShiftLeft<23>(hn::BitCast(kI, shifted))));
}

/// log2 of positive normal numbers, by the series of atanh around 1.
HWY_INLINE F log2_of(F a) {
  const VI bits = hn::BitCast(kI, a.v);
  const VI e = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(kI, 0x3f3504f3)));
  const F m = hn::BitCast(kF, hn::Sub(bits, hn::ShiftLeft<23>(e)));
  const F one(1.0f);
  const F s = (m - one) / (m + one), s2 = s * s;
  F p = mul_add(s2, F(0.412198583f), F(0.577078016f));
  p = mul_add(s2, p, F(0.961796694f));
  p = mul_add(s2, p, F(2.885390082f));
  return mul_add(s, p, F(hn::ConvertTo(kF, e)));
}

#define SGS_SPLAT_INLINE HWY_INLINE
#include "sgs/render/splat_math.inl"
#undef SGS_SPLAT_INLINE

#if HWY_TARGET != HWY_SCALAR
/// Transposes the 4x4 floats in each 128-bit block across four vectors.
HWY_INLINE void transpose_in_blocks(const VF* in, VF* out) {
  const hn::Repartition<double, FloatTag> d64;
  const auto as64 = [&](VF x) { return hn::BitCast(d64, x); };
  const VF a = hn::InterleaveLower(kF, in[0], in[1]), b = hn::InterleaveLower(kF, in[2], in[3]);
  const VF c = hn::InterleaveUpper(kF, in[0], in[1]), d = hn::InterleaveUpper(kF, in[2], in[3]);
  out[0] = hn::BitCast(kF, hn::InterleaveLower(d64, as64(a), as64(b)));
  out[1] = hn::BitCast(kF, hn::InterleaveUpper(d64, as64(a), as64(b)));
  out[2] = hn::BitCast(kF, hn::InterleaveLower(d64, as64(c), as64(d)));
  out[3] = hn::BitCast(kF, hn::InterleaveUpper(d64, as64(c), as64(d)));
}
#endif

/// Transposes a square of kLanes x kLanes floats; `in` and `out` must not overlap.
HWY_INLINE void transpose_square(const VF* in, VF* out) {
#if HWY_TARGET == HWY_SCALAR
  out[0] = in[0];
#elif HWY_MAX_BYTES == 16
  transpose_in_blocks(in, out);
#else
  VF t[kLanes];
  for (int k = 0; k < kLanes / 4; ++k) transpose_in_blocks(in + 4 * k, t + 4 * k);
  for (int c = 0; c < 4; ++c) {
    if constexpr (kLanes == 8) {
      out[c] = hn::ConcatLowerLower(kF, t[4 + c], t[c]);
      out[4 + c] = hn::ConcatUpperUpper(kF, t[4 + c], t[c]);
    } else {
      const VF x0 = t[c], x1 = t[4 + c], x2 = t[8 + c], x3 = t[12 + c];
      const VF p0 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(x1), x0);
      const VF p1 = hn::OddEvenBlocks(x1, hn::SwapAdjacentBlocks(x0));
      const VF p2 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(x3), x2);
      const VF p3 = hn::OddEvenBlocks(x3, hn::SwapAdjacentBlocks(x2));
      out[c] = hn::ConcatLowerLower(kF, p2, p0);
      out[4 + c] = hn::ConcatLowerLower(kF, p3, p1);
      out[8 + c] = hn::ConcatUpperUpper(kF, p2, p0);
      out[12 + c] = hn::ConcatUpperUpper(kF, p3, p1);
    }
  }
#endif
}

/// 16 columns of kLanes rows: column c holds float c of each of the rows.
HWY_INLINE void load_columns(const float* const* rows, F* columns) {
  for (int part = 0; part < kParts; ++part) {
    VF in[kLanes], out[kLanes];
    for (int l = 0; l < kLanes; ++l) in[l] = hn::LoadU(kF, rows[l] + part * kLanes);
    transpose_square(in, out);
    for (int l = 0; l < kLanes; ++l) columns[part * kLanes + l] = out[l];
  }
}

/// The opposite: kLanes rows of 16 floats from 16 columns.
HWY_INLINE void store_rows(const F* columns, float (*rows)[16]) {
  for (int part = 0; part < kParts; ++part) {
    VF in[kLanes], out[kLanes];
    for (int l = 0; l < kLanes; ++l) in[l] = columns[part * kLanes + l].v;
    transpose_square(in, out);
    for (int l = 0; l < kLanes; ++l) hn::StoreU(out[l], kF, rows[l] + part * kLanes);
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
