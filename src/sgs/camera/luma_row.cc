// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/luma_row.h"

#include <algorithm>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/camera/luma_row.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sgs::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void LumaRow(const Rgb8* in, float* out, std::size_t width) {
  constexpr hn::CappedTag<float, 8> tag;
  constexpr hn::Rebind<std::int32_t, decltype(tag)> integers;
  constexpr hn::Rebind<std::uint8_t, decltype(tag)> bytes;
  const std::size_t lanes = hn::Lanes(tag);
  if (width < lanes) {
    std::transform(in, in + width, out, luma);
    return;
  }
  const auto widened = [&](auto channel) {
    return hn::ConvertTo(tag, hn::PromoteTo(integers, channel));
  };
  static_assert(sizeof(Rgb8) == 3);
  const auto* from = reinterpret_cast<const std::uint8_t*>(in);
  // The last vector overlaps the one before it. Multiplied and added in the order of luma().
  for (std::size_t i = 0; i < width; i += lanes) {
    const std::size_t x = std::min(i, width - lanes);
    hn::Vec<decltype(bytes)> r, g, b;
    hn::LoadInterleaved3(bytes, from + 3 * x, r, g, b);
    const auto red_green = hn::Add(hn::Mul(hn::Set(tag, 0.299f), widened(r)),
                                   hn::Mul(hn::Set(tag, 0.587f), widened(g)));
    const auto sum = hn::Add(red_green, hn::Mul(hn::Set(tag, 0.114f), widened(b)));
    hn::StoreU(sum, tag, out + x);
  }
}

}  // namespace sgs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs {
HWY_EXPORT(LumaRow);

void luma_row(const Rgb8* in, float* out, std::size_t width) {
  HWY_DYNAMIC_DISPATCH(LumaRow)(in, out, width);
}

}  // namespace sgs
#endif
