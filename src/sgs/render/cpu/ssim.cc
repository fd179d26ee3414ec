// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/ssim.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/render/cpu/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/render/cpu/ssim.cc"
#include <hwy/foreach_target.h>

#include "sgs/render/cpu/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

/// Symmetric 11-tap filter of value(offset), offset -5..5.
template <class Value>
HWY_INLINE F filter(const SsimTaps& taps, const Value& value) {
  F sum = F(taps.w[0]) * value(0);
  for (int i = 1; i <= 5; ++i) sum = mul_add(F(taps.w[i]), value(-i) + value(i), sum);
  return sum;
}

HWY_INLINE F columns_inside(int x, int width, F v) {
  if (x + kLanes <= width) return v;
  return zero_unless(hn::FirstN(kF, static_cast<std::size_t>(width - x)), v);
}

/// Horizontal filter of x, x^2 and x y.
void FilterProducts(const SsimTaps& taps, int width, const float* x, const float* y, float* out_x,
                    float* out_xx, float* out_xy) {
  for (int i = 0; i < width; i += kLanes) {
    const auto at = [&](int k) HWY_ATTR { return load(x + i + k); };
    const auto at_xx = [&](int k) HWY_ATTR { return load(x + i + k) * load(x + i + k); };
    const auto at_xy = [&](int k) HWY_ATTR { return load(x + i + k) * load(y + i + k); };
    store(filter(taps, at), out_x + i);
    store(filter(taps, at_xx), out_xx + i);
    store(filter(taps, at_xy), out_xy + i);
  }
}

/// Horizontal filter of three rows.
void FilterRows(const SsimTaps& taps, int width, const float* const* in, float* const* out) {
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < width; i += kLanes) {
      const auto at = [&](int o) HWY_ATTR { return load(in[k] + i + o); };
      store(filter(taps, at), out[k] + i);
    }
  }
}

/// Vertical filter of the target's first and second moment into mean and variance.
void TargetRow(const SsimTaps& taps, int width, int stride, const float* m, const float* mm,
               float* mean, float* variance) {
  for (int i = 0; i < width; i += kLanes) {
    const auto at = [&](int o) HWY_ATTR { return load(m + i + o * stride); };
    const auto at2 = [&](int o) HWY_ATTR { return load(mm + i + o * stride); };
    const F mu = filter(taps, at);
    store(columns_inside(i, width, mu), mean + i);
    store(columns_inside(i, width, neg_mul_add(mu, mu, filter(taps, at2))), variance + i);
  }
}

/// Vertical filter of the three moments, SSIM and its derivatives by them; returns sum (1 - SSIM).
double SsimRow(const SsimTaps& taps, int width, int stride, const float* const* moments,
               const float* target_mean, const float* target_variance, float* const* derivative) {
  const F c1(0.01f * 0.01f), c2(0.03f * 0.03f), one(1.0f), two(2.0f), zero(0.0f);
  double sum = 0;
  for (int i = 0; i < width; i += kLanes) {
    F m[3];
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](int o) HWY_ATTR { return load(moments[k] + i + o * stride); };
      m[k] = filter(taps, at);
    }
    const F mx = m[0], my = load(target_mean + i);
    const F A1 = mul_add(two * mx, my, c1), A2 = mul_add(two, neg_mul_add(mx, my, m[2]), c2);
    const F B1 = mul_add(mx, mx, mul_add(my, my, c1));
    const F B2 = neg_mul_add(mx, mx, m[1]) + load(target_variance + i) + c2;
    const F inv = one / (B1 * B2);
    const F ssim = A1 * A2 * inv;
    const F d_xx = zero - ssim / B2, d_xy = two * A1 * inv;
    const F d_x = two * (my * A2 * inv - mx * ssim / B1 - mx * d_xx) - my * d_xy;
    store(columns_inside(i, width, d_x), derivative[0] + i);
    store(columns_inside(i, width, d_xx), derivative[1] + i);
    store(columns_inside(i, width, d_xy), derivative[2] + i);
    alignas(64) float lanes[16];
    store(columns_inside(i, width, one - ssim), lanes);
    for (int l = 0; l < kLanes; ++l) sum += static_cast<double>(lanes[l]);
  }
  return sum;
}

/// Vertical filter of the derivatives, combined to the gradient of (1 - SSIM).
void GradientRow(const SsimTaps& taps, int width, int stride, const float* const* derivative,
                 const float* x, const float* y, float* gradient) {
  for (int i = 0; i < width; i += kLanes) {
    F d[3];
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](int o) HWY_ATTR { return load(derivative[k] + i + o * stride); };
      d[k] = filter(taps, at);
    }
    const F g = mul_add(F(2.0f) * load(x + i), d[1], mul_add(load(y + i), d[2], d[0]));
    store(F(0.0f) - columns_inside(i, width, g), gradient + i);
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::render::cpu {
HWY_EXPORT(FilterProducts);
HWY_EXPORT(FilterRows);
HWY_EXPORT(TargetRow);
HWY_EXPORT(SsimRow);
HWY_EXPORT(GradientRow);

namespace {

SsimTaps make_taps() {
  SsimTaps taps;
  double total = 0, w[6];
  for (int i = 0; i <= 5; ++i) {
    w[i] = std::exp(-i * i / (2 * 1.5 * 1.5));
    total += i == 0 ? w[i] : 2 * w[i];
  }
  for (int i = 0; i <= 5; ++i) taps.w[i] = static_cast<float>(w[i] / total);
  return taps;
}

const SsimTaps kTaps = make_taps();
constexpr int kBand = 16;  // rows per chunk of work

template <class Body>
void for_rows(int height, ThreadPool& pool, const Body& body) {
  pool.run((height + kBand - 1) / kBand, [&](int band, int) {
    for (int y = band * kBand; y < std::min(height, (band + 1) * kBand); ++y) body(y);
  });
}

void match_size(PaddedPlane& plane, int width, int height) {
  if (plane.width != width || plane.height != height) plane = PaddedPlane(width, height);
}

}  // namespace

TargetMoments::TargetMoments(PaddedPlane channel)
    : y(std::move(channel)), mean(y.width, y.height), variance(y.width, y.height) {
  PaddedPlane m(y.width, y.height), mm(y.width, y.height), unused(y.width, y.height);
  for (int r = 0; r < y.height; ++r) {
    HWY_DYNAMIC_DISPATCH(FilterProducts)
    (kTaps, y.width, y.row(r), y.row(r), m.row(r), mm.row(r), unused.row(r));
  }
  for (int r = 0; r < y.height; ++r) {
    HWY_DYNAMIC_DISPATCH(TargetRow)
    (kTaps, y.width, y.stride, m.row(r), mm.row(r), mean.row(r), variance.row(r));
  }
}

void Dssim::reserve(int width, int height) {
  for (auto* planes : {rows_, derivative_}) {
    for (int k = 0; k < 3; ++k) match_size(planes[k], width, height);
  }
  row_values_.resize(static_cast<std::size_t>(height));
}

double Dssim::evaluate(const PaddedPlane& x, const TargetMoments& target, PaddedPlane& gradient,
                       ThreadPool& pool) {
  const int w = x.width, h = x.height;
  reserve(w, h);
  match_size(gradient, w, h);
  for_rows(h, pool, [&](int y) {
    HWY_DYNAMIC_DISPATCH(FilterProducts)
    (kTaps, w, x.row(y), target.y.row(y), rows_[0].row(y), rows_[1].row(y), rows_[2].row(y));
  });
  for_rows(h, pool, [&](int y) {
    const float* const moments[3] = {rows_[0].row(y), rows_[1].row(y), rows_[2].row(y)};
    float* const out[3] = {derivative_[0].row(y), derivative_[1].row(y), derivative_[2].row(y)};
    row_values_[static_cast<std::size_t>(y)] = HWY_DYNAMIC_DISPATCH(SsimRow)(
        kTaps, w, x.stride, moments, target.mean.row(y), target.variance.row(y), out);
  });
  for_rows(h, pool, [&](int y) {
    const float* const in[3] = {derivative_[0].row(y), derivative_[1].row(y),
                                derivative_[2].row(y)};
    float* const out[3] = {rows_[0].row(y), rows_[1].row(y), rows_[2].row(y)};
    HWY_DYNAMIC_DISPATCH(FilterRows)(kTaps, w, in, out);
  });
  for_rows(h, pool, [&](int y) {
    const float* const in[3] = {rows_[0].row(y), rows_[1].row(y), rows_[2].row(y)};
    HWY_DYNAMIC_DISPATCH(GradientRow)
    (kTaps, w, x.stride, in, x.row(y), target.y.row(y), gradient.row(y));
  });
  double sum = 0;
  for (const double v : row_values_) sum += v;
  return sum;
}

}  // namespace sgs::render::cpu
#endif
