// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/adam.h"

#include <algorithm>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/mapper/adam.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sgs::mapper::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;
inline constexpr Tag kTag;
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));
inline constexpr int kParts = 16 / kLanes;
// log_scale is floats 3 to 5 of a row.
inline constexpr int kFirstScale = 3, kScales = 3;

using Halves = hn::Rebind<std::uint16_t, Tag>;
using Words = hn::RebindToUnsigned<Tag>;
using W = hn::Vec<Words>;

HWY_INLINE V from_bfloat(const std::uint16_t* p) {
  const W words = hn::PromoteTo(Words(), hn::LoadU(Halves(), p));
  return hn::BitCast(kTag, hn::ShiftLeft<16>(words));
}

/// `dither` (below 2^16) is added to what is cut off, so that the rounding of many steps has no
/// bias: an average that changes by less than the last digit would otherwise stand still.
HWY_INLINE void to_bfloat(V v, W dither, std::uint16_t* p) {
  const W words = hn::ShiftRight<16>(hn::Add(hn::BitCast(Words(), v), dither));
  hn::StoreU(hn::TruncateTo(Halves(), words), Halves(), p);
}

/// 1 / sqrt(a) for normal a > 0, to nearly full precision.
HWY_INLINE V reciprocal_root(V a) {
  constexpr int kSteps = kLanes >= 8 ? 1 : 2;  // of Newton's method; estimates differ
  V r = hn::ApproximateReciprocalSqrt(a);
  const V half_a = hn::Mul(hn::Set(kTag, 0.5f), a);
  for (int i = 0; i < kSteps; ++i) {
    r = hn::Mul(r, hn::NegMulAdd(hn::Mul(half_a, r), r, hn::Set(kTag, 1.5f)));
  }
  return r;
}

/// Limits the logarithmic axes of a Gaussian. Capping keeps the order of the axes, so that the
/// middle one of the capped axes is the capped middle one.
inline void cap_axes(const AdamSettings& settings, float max_log_scale, float* s) {
  const float low = std::min(s[0], s[1]), high = std::max(s[0], s[1]);
  const float middle = std::max(low, std::min(high, s[2]));
  const float top = std::min(middle + settings.log_axis_ratio, max_log_scale);
  const float bottom = std::min(middle, max_log_scale) - settings.log_flatness;
  for (int k = 0; k < kScales; ++k) s[k] = std::max(std::min(s[k], top), bottom);
}

#if HWY_TARGET != HWY_SCALAR
/// The same within a vector that holds floats 0 to 7 of a row or more.
class AxisCaps {
 public:
  explicit AxisCaps(const AdamSettings& settings)
      : ratio_(hn::Set(kTag, settings.log_axis_ratio)),
        flatness_(hn::Set(kTag, settings.log_flatness)) {
    alignas(64) std::int32_t next[16], last[16];
    alignas(64) float is_scale[16];
    for (int l = 0; l < kLanes; ++l) {
      const bool scale = l >= kFirstScale && l < kFirstScale + kScales;
      next[l] = scale ? kFirstScale + (l - kFirstScale + 1) % kScales : l;
      last[l] = scale ? kFirstScale + (l - kFirstScale + 2) % kScales : l;
      is_scale[l] = scale ? 1.0f : 0.0f;
    }
    next_ = hn::SetTableIndices(kTag, next);
    last_ = hn::SetTableIndices(kTag, last);
    scales_ = hn::Gt(hn::Load(kTag, is_scale), hn::Zero(kTag));
  }

  HWY_INLINE V apply(V s, float max_log_scale) const {
    const V b = hn::TableLookupLanes(s, next_), c = hn::TableLookupLanes(s, last_);
    const V middle = hn::Max(hn::Min(s, b), hn::Min(hn::Max(s, b), c));
    const V limit = hn::Set(kTag, max_log_scale);
    const V top = hn::Min(hn::Add(middle, ratio_), limit);
    const V bottom = hn::Sub(hn::Min(middle, limit), flatness_);
    return hn::IfThenElse(scales_, hn::Max(hn::Min(s, top), bottom), s);
  }

 private:
  V ratio_, flatness_;
  decltype(hn::SetTableIndices(kTag, static_cast<const std::int32_t*>(nullptr))) next_, last_;
  hn::Mask<Tag> scales_;
};
#endif

/// Where the step after `t` others stands in the tables; beyond their end the last period is
/// repeated.
inline std::uint32_t table_entry(const AdamSettings& settings, std::uint32_t t) {
  const std::uint32_t size = settings.table_size;
  constexpr std::uint32_t kPeriod = AdamSettings::kAverageInterval;
  return t < size ? t : size - kPeriod + t % kPeriod;
}

void AdamStep(const AdamSettings& settings, const AdamRows& rows, const std::uint32_t* indices,
              const map::Gaussian* gradient, std::size_t count) {
  constexpr std::size_t kAhead = 16;
  constexpr bool kCapsInVector = kLanes >= 8;
  // Where the second moment is smaller the gradient is noise of rounding.
  const V least_moment2 = hn::Set(kTag, 1e-24f);
  const V b1 = hn::Set(kTag, settings.beta1), rest1 = hn::Set(kTag, 1 - settings.beta1);
  const V b2 = hn::Set(kTag, settings.beta2), rest2 = hn::Set(kTag, 1 - settings.beta2);
#if HWY_TARGET != HWY_SCALAR
  const AxisCaps caps(settings);
#endif
  // Multiples of an odd number near 2^16 divided by the golden ratio spread evenly over 16 bits.
  constexpr std::uint32_t kGolden = 40503;
  alignas(64) std::uint32_t lane_dither[16];
  for (std::uint32_t l = 0; l < 16; ++l) lane_dither[l] = l * 25033u;
  const W low_half = hn::Set(Words(), 0xffff);
  for (std::size_t n = 0; n < count; ++n) {
    if (n + kAhead < count) {
      const std::size_t ahead = indices[n + kAhead];
      __builtin_prefetch(&rows.moments[ahead], 1);
      if (settings.average_share[table_entry(settings, rows.steps[ahead])] != 0) {
        __builtin_prefetch(&rows.average[ahead], 1);
      }
    }
    const std::size_t i = indices[n];
    const std::uint32_t t = rows.steps[i]++;
    const std::uint32_t entry = table_entry(settings, t);
    const V rate = hn::Set(kTag, settings.correction1[entry] / settings.correction2[entry]);
    // Rows are arrays of 16 floats in all but name (map::Gaussian).
    const auto* g = reinterpret_cast<const float*>(&gradient[n]);
    auto* value = reinterpret_cast<float*>(&rows.value[i]);
    auto* average = reinterpret_cast<float*>(&rows.average[i]);
    map::Moments& moments = rows.moments[i];
    const W step_dither = hn::Set(Words(), t * kGolden);
    for (int at = 0; at < 16; at += kLanes) {
      const V d = hn::LoadU(kTag, g + at);
      const V m = hn::MulAdd(rest1, d, hn::Mul(b1, from_bfloat(moments.mean + at)));
      const V v =
          hn::MulAdd(hn::Mul(rest2, d), d, hn::Mul(b2, from_bfloat(moments.mean_square + at)));
      const W dither = hn::And(hn::Add(step_dither, hn::Load(Words(), lane_dither + at)), low_half);
      to_bfloat(m, dither, moments.mean + at);
      to_bfloat(v, dither, moments.mean_square + at);
      const V direction = hn::Mul(m, reciprocal_root(hn::Max(v, least_moment2)));
      const V length = hn::Mul(rate, hn::Load(kTag, settings.rate + at));
      V x = hn::NegMulAdd(length, direction, hn::LoadU(kTag, value + at));
#if HWY_TARGET != HWY_SCALAR
      if (kCapsInVector && at == 0) x = caps.apply(x, rows.max_log_scale[i]);
#endif
      hn::StoreU(x, kTag, value + at);
    }
    if (!kCapsInVector) cap_axes(settings, rows.max_log_scale[i], value + kFirstScale);
    if (settings.average_share[entry] == 0) continue;
    const V share = hn::Set(kTag, settings.average_share[entry]);
    for (int at = 0; at < 16; at += kLanes) {
      const V a = hn::LoadU(kTag, average + at);
      const V x = hn::LoadU(kTag, value + at);
      hn::StoreU(hn::MulAdd(share, hn::Sub(x, a), a), kTag, average + at);
    }
  }
}

}  // namespace sgs::mapper::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::mapper {
HWY_EXPORT(AdamStep);

void adam_step(const AdamSettings& settings, const AdamRows& rows, const std::uint32_t* indices,
               const map::Gaussian* gradient, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(AdamStep)(settings, rows, indices, gradient, count);
}

}  // namespace sgs::mapper
#endif
