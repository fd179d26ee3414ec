// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/splat_backward.h"

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/render/cpu/splat_backward.cc"
#include <hwy/foreach_target.h>

#include "sgs/render/cpu/reduce-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

/// Adds up a Gaussian's slots in tile order.
HWY_INLINE void sum_slots(const SplatBackwardJob& job, std::uint32_t begin, std::uint32_t end,
                          float* out) {
  F sum[kParts];
  for (F& s : sum) s = F(0.0f);
  for (std::uint32_t i = begin; i < end; ++i) {
    if (!job.slot_used[i]) continue;
    for (int part = 0; part < kParts; ++part) {
      sum[part] = sum[part] + load(job.slots[i].lane + part * kLanes);
    }
  }
  for (int part = 0; part < kParts; ++part) store(sum[part], out + part * kLanes);
}

void SplatBackwardChunk(const View<float>& view, const SplatBackwardJob& job) {
  constexpr std::uint32_t kGaussiansAhead = 16, kSlotsAhead = kSlotsReadAhead - 2;
  F twist[6];
  for (F& t : twist) t = F(0.0f);
  for (std::uint32_t i = 0; i < job.visible; i += kLanes) {
    const std::uint32_t n = job.visible - i < kLanes ? job.visible - i : kLanes;
    const float* parameter_rows[kLanes];
    const float* sum_rows[kLanes];
    alignas(64) float sums[kLanes][16];
    for (std::uint32_t l = 0; l < kLanes; ++l) {
      const std::uint32_t k = i + (l < n ? l : 0);
      parameter_rows[l] = job.gaussians[job.sources[k]].mean;
      sum_rows[l] = sums[l];
      if (k + kGaussiansAhead < job.visible) {
        __builtin_prefetch(job.gaussians[job.sources[k + kGaussiansAhead]].mean);
      }
      const std::uint32_t begin = job.first_slot[k];
      __builtin_prefetch(&job.slots[begin + kSlotsAhead]);
      __builtin_prefetch(&job.slots[begin + kSlotsAhead + 1]);
      sum_slots(job, begin, job.first_slot[k + 1], sums[l]);
    }
    F s[16], t[16];
    load_columns(parameter_rows, s);
    load_columns(sum_rows, t);
    const F mean[3] = {s[0], s[1], s[2]};
    const Splat<F> shape = {
        {s[0], s[1], s[2]}, {s[3], s[4], s[5]}, {s[6], s[7], s[8], s[9]}, s[10]};
    const auto p = to_camera(view, mean);
    const auto o = project(view, p, shape);
    ImageGradient<F> in;
    in.h = t[sum_lane(0)];
    in.hx = t[sum_lane(1)];
    in.hy = t[sum_lane(2)];
    in.hxx = t[sum_lane(3)];
    in.hxy = t[sum_lane(4)];
    in.hyy = t[sum_lane(5)];
    for (int c = 0; c < 3; ++c) in.rgb[c] = t[sum_lane(6 + c)];
    in.z = t[sum_lane(9)];
    const auto g = splat_backward(view, p, o, in);

    const F zero(0.0f);
    const F columns[16] = {g.mean[0],
                           g.mean[1],
                           g.mean[2],
                           g.log_scale[0],
                           g.log_scale[1],
                           g.log_scale[2],
                           g.rotation[0],
                           g.rotation[1],
                           g.rotation[2],
                           g.rotation[3],
                           g.opacity_logit,
                           in.rgb[0],
                           in.rgb[1],
                           in.rgb[2],
                           zero,
                           zero};
    alignas(64) float rows[kLanes][16];
    store_rows(columns, rows);
    for (std::uint32_t l = 0; l < n; ++l) {
      float* to = job.gradient[i + l].mean;
      for (int part = 0; part < kParts; ++part) {
        store(load(rows[l] + part * kLanes), to + part * kLanes);
      }
    }
    const Mask counts = hn::FirstN(kF, n);
    for (int k = 0; k < 6; ++k) twist[k] = twist[k] + zero_unless(counts, g.twist[k]);
  }
  for (int k = 0; k < 6; ++k) {
    alignas(64) float lanes[16];
    store(twist[k], lanes);
    for (int l = 0; l < kLanes; ++l) job.twist[k] += static_cast<double>(lanes[l]);
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::render::cpu {
HWY_EXPORT(SplatBackwardChunk);

void splat_backward_chunk(const View<float>& view, const SplatBackwardJob& job) {
  HWY_DYNAMIC_DISPATCH(SplatBackwardChunk)(view, job);
}
}  // namespace sgs::render::cpu
#endif
