// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_row.h"

#include <algorithm>
#include <cstddef>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/camera/depth_row.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SGS_CAMERA_DEPTH_ROW_ONCE
#define SGS_CAMERA_DEPTH_ROW_ONCE
namespace sgs {
namespace {

constexpr float kFarthest_m = 100;     // what an offset moves beyond is no measurement
constexpr float kSameSurface = 0.03f;  // relative spread of the depths of one surface

}  // namespace
}  // namespace sgs
#endif

HWY_BEFORE_NAMESPACE();
namespace sgs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The inverse depths w00 / a + w10 / b + w01 / c + w11 / d and 1 / z are kept as fractions: with
// the offset in, one division is left.
template <class Tag>
HWY_INLINE void CorrectLanes(Tag tag, const DepthRow& row, std::size_t x, float* corrected) {
  const auto f = [&](float value) { return hn::Set(tag, value); };
  const std::size_t next = x + (row.dx > 0 ? 1 : 0);
  const auto a = hn::LoadU(tag, row.top + x), b = hn::LoadU(tag, row.top + next);
  const auto c = hn::LoadU(tag, row.bottom + x), d = hn::LoadU(tag, row.bottom + next);
  const auto zero = hn::Zero(tag);
  const auto low = hn::Min(hn::Min(a, b), hn::Min(c, d));
  const auto high = hn::Max(hn::Max(a, b), hn::Max(c, d));
  const auto smooth =
      hn::And(hn::Gt(low, zero), hn::Lt(hn::Sub(high, low), hn::Mul(f(kSameSurface), low)));
  const auto ab = hn::Mul(a, b), cd = hn::Mul(c, d);
  const auto above =
      hn::MulAdd(f((1 - row.dx) * (1 - row.dy)), b, hn::Mul(f(row.dx * (1 - row.dy)), a));
  const auto below = hn::MulAdd(f((1 - row.dx) * row.dy), d, hn::Mul(f(row.dx * row.dy), c));
  const auto between = hn::MulAdd(above, cd, hn::Mul(below, ab));
  const auto left = row.dy > 0.5f ? c : a, right = row.dy > 0.5f ? d : b;
  const auto nearest = row.dx > 0.5f ? right : left;
  const auto numerator = hn::IfThenElse(smooth, between, f(1));
  const auto denominator = hn::IfThenElse(smooth, hn::Mul(ab, cd), nearest);
  const auto moved =
      hn::MulAdd(hn::LoadU(tag, row.offset_per_m.data() + x), denominator, numerator);
  const auto measured =
      hn::And(hn::Gt(denominator, zero), hn::Gt(hn::Mul(f(kFarthest_m), moved), denominator));
  const auto depth = hn::Div(denominator, hn::IfThenElse(measured, moved, f(1)));
  hn::StoreU(hn::IfThenElseZero(measured, depth), tag, corrected + x);
}

void CorrectDepth(const DepthRow& row, float* corrected) {
  constexpr hn::CappedTag<float, 16> tag;
  const std::size_t lanes = hn::Lanes(tag), length = row.offset_per_m.size();
  if (length < lanes) {
    for (std::size_t x = 0; x < length; ++x) {
      CorrectLanes(hn::CappedTag<float, 1>(), row, x, corrected);
    }
    return;
  }
  // The last vector overlaps the one before it.
  for (std::size_t x = 0; x < length; x += lanes) {
    CorrectLanes(tag, row, std::min(x, length - lanes), corrected);
  }
}

}  // namespace sgs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs {
HWY_EXPORT(CorrectDepth);

void correct_depth(const DepthRow& row, float* corrected) {
  HWY_DYNAMIC_DISPATCH(CorrectDepth)(row, corrected);
}

}  // namespace sgs
#endif
