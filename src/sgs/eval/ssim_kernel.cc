// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/ssim_kernel.h"

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/eval/ssim_kernel.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sgs::eval::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 8>;
using V = hn::Vec<Tag>;
inline constexpr Tag kTag;

/// The five moments over the columns of the window whose first row is `top`.
HWY_INLINE void vertical_pass(const SsimJob& job, std::size_t top) {
  const std::size_t lanes = hn::Lanes(kTag);
  for (std::size_t i = 0; i < job.width; i += lanes) {
    V mx = hn::Zero(kTag), my = mx, mxx = mx, myy = mx, mxy = mx;
    for (std::size_t k = 0; k < kSsimWindow; ++k) {
      const std::size_t at = (top + k) * job.width + i;
      const V w = hn::Set(kTag, job.weight[k]);
      const V x = hn::LoadU(kTag, job.x + at), y = hn::LoadU(kTag, job.y + at);
      const V wx = hn::Mul(w, x), wy = hn::Mul(w, y);
      mx = hn::Add(mx, wx);
      my = hn::Add(my, wy);
      mxx = hn::MulAdd(wx, x, mxx);
      myy = hn::MulAdd(wy, y, myy);
      mxy = hn::MulAdd(wx, y, mxy);
    }
    const V sums[5] = {mx, my, mxx, myy, mxy};
    for (int m = 0; m < 5; ++m) hn::StoreU(sums[m], kTag, job.moments[m] + i);
  }
}

double SsimSum(const SsimJob& job) {
  const std::size_t lanes = hn::Lanes(kTag), inner = job.width - 2 * kSsimRadius;
  const V c1 = hn::Set(kTag, 0.01 * 0.01), c2 = hn::Set(kTag, 0.03 * 0.03);
  const V two = hn::Set(kTag, 2.0);
  V total = hn::Zero(kTag);
  for (std::size_t top = 0; top + kSsimWindow <= job.height; ++top) {
    vertical_pass(job, top);
    for (std::size_t i = 0; i < inner; i += lanes) {
      V u[5];
      for (V& v : u) v = hn::Zero(kTag);
      for (std::size_t k = 0; k < kSsimWindow; ++k) {
        const V w = hn::Set(kTag, job.weight[k]);
        for (int m = 0; m < 5; ++m) {
          u[m] = hn::MulAdd(w, hn::LoadU(kTag, job.moments[m] + i + k), u[m]);
        }
      }
      const V xx = hn::Mul(u[0], u[0]), yy = hn::Mul(u[1], u[1]), xy = hn::Mul(u[0], u[1]);
      const V variances = hn::Add(hn::Sub(u[2], xx), hn::Sub(u[3], yy));
      const V above = hn::Mul(hn::MulAdd(two, xy, c1), hn::MulAdd(two, hn::Sub(u[4], xy), c2));
      const V below = hn::Mul(hn::Add(hn::Add(xx, yy), c1), hn::Add(variances, c2));
      const auto counts = hn::FirstN(kTag, inner - i);
      total = hn::Add(total, hn::IfThenElseZero(counts, hn::Div(above, below)));
    }
  }
  alignas(64) double lane[8];
  hn::Store(total, kTag, lane);
  double sum = 0;
  for (std::size_t l = 0; l < lanes; ++l) sum += lane[l];
  return sum;
}

}  // namespace sgs::eval::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::eval {
HWY_EXPORT(SsimSum);

double ssim_sum(const SsimJob& job) { return HWY_DYNAMIC_DISPATCH(SsimSum)(job); }
}  // namespace sgs::eval
#endif
