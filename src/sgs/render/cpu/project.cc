// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/project.h"

#include <cstring>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/render/cpu/project.cc"
#include <hwy/foreach_target.h>

#include "sgs/render/cpu/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

// Which lanes hold a Gaussian that can be seen at all. Every test is false for NaN.
HWY_INLINE Mask plausible(const View<float>& view, const CameraPoint<F>& p, const F* s, int count) {
  const F m(kOutsideMargin);
  const F norm2 = mul_add(s[6], s[6], dot3(s[7], s[7], s[8], s[8], s[9], s[9]));
  Mask ok = hn::FirstN(kF, static_cast<std::size_t>(count));
  ok = hn::And(ok, hn::And(p.z > F(kNearest_m), p.z < F(kFarthest_m)));
  ok = hn::And(ok, hn::And(p.u > F(view.u_min) - m, p.u < F(view.u_max) + m));
  ok = hn::And(ok, hn::And(p.v > F(view.v_min) - m, p.v < F(view.v_max) + m));
  for (int i = 3; i < 6; ++i) {
    // ln(kMaxScale_m); the lower bound keeps minus infinity out.
    ok = hn::And(ok, hn::And(s[i]<F(6.907755f), s[i]> F(-80.0f)));
  }
  ok = hn::And(ok, hn::And(norm2 > F(1e-12f), norm2 < F(1e12f)));
  ok = hn::And(ok, absolute(s[10]) < F(1e30f));
  for (int i = 11; i < 14; ++i) ok = hn::And(ok, absolute(s[i]) < F(kMaxColor));
  return ok;
}

struct PixelBox {
  VI x0, y0, x1, y1;
};

HWY_INLINE PixelBox pixel_box(const View<float>& view, F x, F y, F ex, F ey) {
  const F zero(0.0f), w(view.width - 1.0f), h(view.height - 1.0f), low(-1.0f);
  PixelBox box;
  box.x0 = hn::ConvertTo(kI, hn::Ceil(minimum(maximum(x - ex, zero), w + F(1.0f)).v));
  box.y0 = hn::ConvertTo(kI, hn::Ceil(minimum(maximum(y - ey, zero), h + F(1.0f)).v));
  box.x1 = hn::ConvertTo(kI, hn::Floor(maximum(minimum(x + ex, w), low).v));
  box.y1 = hn::ConvertTo(kI, hn::Floor(maximum(minimum(y + ey, h), low).v));
  return box;
}

HWY_INLINE std::uint32_t depth_key(float z) {
  std::uint32_t bits;
  std::memcpy(&bits, &z, sizeof bits);
  const std::uint32_t key = (bits - 0x3d000000u) >> 5;  // z > 2^-5 m, 18 bits of mantissa
  return key < (1u << kKeyBits) ? key : (1u << kKeyBits) - 1;
}

void ProjectChunk(const View<float>& view, const map::Gaussian* gaussians,
                  const std::uint32_t* indices, std::uint32_t count, const ProjectedChunk& to,
                  ChunkCount& found) {
  const ProjectedChunk out = to;  // a copy, which the bytes written below cannot alias
  ChunkCount total;
  constexpr std::uint32_t kAhead = 64;
  for (std::uint32_t i = 0; i < count; i += kLanes) {
    const int n = static_cast<int>(count - i) < kLanes ? static_cast<int>(count - i) : kLanes;
    const float* rows[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      rows[l] = gaussians[indices[i + static_cast<std::uint32_t>(l < n ? l : 0)]].mean;
      if (i + kAhead + kLanes <= count) {
        __builtin_prefetch(gaussians[indices[i + kAhead + static_cast<std::uint32_t>(l)]].mean);
      }
    }
    F s[16];
    load_columns(rows, s);
    const F mean[3] = {s[0], s[1], s[2]};
    const auto p = to_camera(view, mean);
    Mask visible = plausible(view, p, s, n);
    if (hn::AllFalse(kF, visible)) continue;
    const Splat<F> shape = {
        {s[0], s[1], s[2]}, {s[3], s[4], s[5]}, {s[6], s[7], s[8], s[9]}, s[10]};
    const auto o = project(view, p, shape);
    // 2 ln(255 o), a hair larger so that rounding never loses a pixel.
    const F reach2 = F(2.0f * kLn2 * 1.0001f) * (o.log2_opacity + F(kLog2Of255));
    visible = hn::And(visible, reach2 > F(0.0f));
    visible = hn::And(visible, maximum(o.cov_xx, o.cov_yy) < F(kMaxVariance_px2));
    if (hn::AllFalse(kF, visible)) continue;
    const F ex = square_root(reach2 * o.cov_xx), ey = square_root(reach2 * o.cov_yy);
    const PixelBox box = pixel_box(view, o.mean_x, o.mean_y, ex, ey);
    const auto filled = hn::Not(hn::Or(hn::Gt(box.x0, box.x1), hn::Gt(box.y0, box.y1)));
    visible = hn::And(visible, hn::RebindMask(kF, filled));

    const F columns[16] = {o.mean_x,
                           o.mean_y,
                           F(-0.5f * kLog2E) * o.conic_xx,
                           F(-kLog2E) * o.conic_xy,
                           F(-0.5f * kLog2E) * o.conic_yy,
                           o.log2_opacity,
                           s[11],
                           s[12],
                           s[13],
                           p.z,
                           ex,
                           ey,
                           F(0.0f),
                           F(0.0f),
                           o.cov_xy / o.cov_xx,
                           reach2 / o.conic_xx};
    alignas(64) float packed[kLanes][16];
    store_rows(columns, packed);
    alignas(64) std::int32_t x0[16], y0[16], x1[16], y1[16];
    hn::Store(hn::ShiftRight<5>(box.x0), kI, x0);
    hn::Store(hn::ShiftRight<5>(box.y0), kI, y0);
    hn::Store(hn::ShiftRight<5>(box.x1), kI, x1);
    hn::Store(hn::ShiftRight<5>(box.y1), kI, y1);
    alignas(8) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kF, visible, bits);
    std::uint32_t mask = static_cast<std::uint32_t>(bits[0]) | static_cast<std::uint32_t>(bits[1])
                                                                   << 8;
    while (mask != 0) {
      const int l = __builtin_ctz(mask);
      mask &= mask - 1;
      const TileRect rect = {static_cast<std::uint8_t>(x0[l]), static_cast<std::uint8_t>(y0[l]),
                             static_cast<std::uint8_t>(x1[l]), static_cast<std::uint8_t>(y1[l])};
      const std::uint32_t k = total.visible++, source = indices[i + static_cast<std::uint32_t>(l)];
      Record& r = out.records[k];
      std::memcpy(&r, packed[l], sizeof r);
      r.rect = rect;
      r.slot = total.slots;
      out.sources[k] = source;
      out.first_slot[k] = total.slots;
      total.slots += static_cast<std::uint32_t>((x1[l] - x0[l] + 1) * (y1[l] - y0[l] + 1));
      out.rects[k] = rect;
      out.keys[k] = depth_key(r.z);
    }
  }
  out.first_slot[total.visible] = total.slots;
  found = total;
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::render::cpu {
HWY_EXPORT(ProjectChunk);

ChunkCount project_chunk(const View<float>& view, const map::Gaussian* gaussians,
                         std::span<const std::uint32_t> indices, const ProjectedChunk& out) {
  ChunkCount found;
  HWY_DYNAMIC_DISPATCH(ProjectChunk)
  (view, gaussians, indices.data(), static_cast<std::uint32_t>(indices.size()), out, found);
  return found;
}
}  // namespace sgs::render::cpu
#endif
