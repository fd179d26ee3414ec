// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/plane_window.h"

#include <cstddef>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/registration/plane_window.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sgs::registration::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One vector holds a row of the window, or half a row where vectors are shorter.
using Tag = hn::CappedTag<float, kWindowColumns>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));

HWY_INLINE float sum(V v) { return hn::GetLane(hn::SumOfLanes(kTag, v)); }

// The columns from `begin` on. Sums are kept per column; the moments in x follow from them.
HWY_INLINE void AddColumns(const Window& window, const WindowPlane& plane, int begin,
                           WindowSums& out) {
  const V columns = hn::Iota(kTag, static_cast<float>(begin));
  const V dx = hn::Mul(hn::Sub(columns, hn::Set(kTag, static_cast<float>(window.half))),
                       hn::Set(kTag, window.step));
  const auto inside = hn::Le(columns, hn::Set(kTag, static_cast<float>(2 * window.half)));
  const V gate = hn::IfThenElse(inside, hn::Set(kTag, plane.gate), hn::Set(kTag, -1.0f));
  const V slope = hn::Mul(hn::Set(kTag, plane.alpha), dx);
  const V zero = hn::Zero(kTag), one = hn::Set(kTag, 1.0f);
  V n = zero, y = zero, yy = zero, e = zero, ye = zero, ee = zero;
  const float* q_row = window.first + begin;
  float dy = window.first_dy;
  for (int j = 0; j < window.rows; ++j, q_row += window.stride, dy += window.step) {
    const V q = hn::LoadU(kTag, q_row);
    const V at = hn::Set(kTag, dy);
    const V expected = hn::Add(hn::Set(kTag, plane.gamma + plane.beta * dy), slope);
    const V residual = hn::Sub(q, expected);
    const auto accepted = hn::And(hn::Gt(q, zero), hn::Le(hn::Abs(residual), gate));
    const V w = hn::IfThenElseZero(accepted, one), r = hn::IfThenElseZero(accepted, residual);
    const V wy = hn::Mul(w, at);
    n = hn::Add(n, w);
    y = hn::Add(y, wy);
    yy = hn::MulAdd(wy, at, yy);
    e = hn::Add(e, r);
    ye = hn::MulAdd(r, at, ye);
    ee = hn::MulAdd(r, r, ee);
  }
  const V nx = hn::Mul(n, dx);
  out.n += sum(n);
  out.x += sum(nx);
  out.y += sum(y);
  out.xx += sum(hn::Mul(nx, dx));
  out.xy += sum(hn::Mul(y, dx));
  out.yy += sum(yy);
  out.e += sum(e);
  out.xe += sum(hn::Mul(e, dx));
  out.ye += sum(ye);
  out.ee += sum(ee);
}

WindowSums SumWindow(const Window& window, const WindowPlane& plane) {
  WindowSums out;
  for (int begin = 0; begin < kWindowColumns; begin += kLanes) {
    AddColumns(window, plane, begin, out);
  }
  return out;
}

}  // namespace sgs::registration::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::registration {
HWY_EXPORT(SumWindow);

WindowSums sum_window(const Window& window, const WindowPlane& plane) {
  return HWY_DYNAMIC_DISPATCH(SumWindow)(window, plane);
}

}  // namespace sgs::registration
#endif
