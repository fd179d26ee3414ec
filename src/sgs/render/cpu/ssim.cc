// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/ssim.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/core/simd_targets.h"

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
    // Each product once, not once per tap that needs it on either side.
    F sum_x(0.0f), sum_xx(0.0f), sum_xy(0.0f);
    const auto add = [&](F w, int k) HWY_ATTR {
      const F value = load(x + i + k), weighted = w * value;
      sum_x = sum_x + weighted;
      sum_xx = mul_add(weighted, value, sum_xx);
      sum_xy = mul_add(weighted, load(y + i + k), sum_xy);
    };
    for (int k = -5; k <= 5; ++k) add(F(taps.w[k < 0 ? -k : k]), k);
    store(sum_x, out_x + i);
    store(sum_xx, out_xx + i);
    store(sum_xy, out_xy + i);
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

/// Vertical filter of a measured channel's first and second moment into mean and variance.
void MeasuredRow(const SsimTaps& taps, int width, int stride, const float* m, const float* mm,
                 float* mean, float* variance) {
  for (int i = 0; i < width; i += kLanes) {
    const auto at = [&](int o) HWY_ATTR { return load(m + i + o * stride); };
    const auto at2 = [&](int o) HWY_ATTR { return load(mm + i + o * stride); };
    const F mu = filter(taps, at);
    store(columns_inside(i, width, mu), mean + i);
    store(columns_inside(i, width, neg_mul_add(mu, mu, filter(taps, at2))), variance + i);
  }
}

/// Columns of a band that are filtered vertically at a time: few enough that the rows the window
/// reaches stay in the first cache.
constexpr int kStrip = 64;

/// Vertical filter of the three moments, SSIM and its derivatives by them over rows [y0, y1);
/// returns sum (1 - SSIM).
double SsimBand(const SsimTaps& taps, const PaddedPlane* moments, const PaddedPlane& measured_mean,
                const PaddedPlane& measured_variance, int y0, int y1, PaddedPlane* derivative) {
  const F c1(0.01f * 0.01f), c2(0.03f * 0.03f), one(1.0f), two(2.0f), zero(0.0f);
  const int width = moments[0].width, stride = moments[0].stride;
  double sum = 0;
  for (int x0 = 0; x0 < width; x0 += kStrip) {
    const int x1 = x0 + kStrip < width ? x0 + kStrip : width;
    F lost = zero;
    for (int y = y0; y < y1; ++y) {
      for (int i = x0; i < x1; i += kLanes) {
        F m[3];
        for (int k = 0; k < 3; ++k) {
          const float* column = moments[k].row(y) + i;
          const auto at = [&](int o) HWY_ATTR { return load(column + o * stride); };
          m[k] = filter(taps, at);
        }
        const F mx = m[0], my = load(measured_mean.row(y) + i);
        const F A1 = mul_add(two * mx, my, c1), A2 = mul_add(two, neg_mul_add(mx, my, m[2]), c2);
        const F B1 = mul_add(mx, mx, mul_add(my, my, c1));
        const F B2 = neg_mul_add(mx, mx, m[1]) + load(measured_variance.row(y) + i) + c2;
        const F inv = one / (B1 * B2);
        const F ssim = A1 * A2 * inv;
        const F d_xx = zero - ssim * B1 * inv, d_xy = two * A1 * inv;
        const F d_x = two * (my * A2 * inv - mx * ssim * B2 * inv - mx * d_xx) - my * d_xy;
        store(columns_inside(i, width, d_x), derivative[0].row(y) + i);
        store(columns_inside(i, width, d_xx), derivative[1].row(y) + i);
        store(columns_inside(i, width, d_xy), derivative[2].row(y) + i);
        lost = lost + columns_inside(i, width, one - ssim);
      }
    }
    alignas(64) float lanes[16];
    store(lost, lanes);
    for (int l = 0; l < kLanes; ++l) sum += static_cast<double>(lanes[l]);
  }
  return sum;
}

/// Vertical filter of the derivatives over rows [y0, y1), combined to the gradient of (1 - SSIM).
void GradientBand(const SsimTaps& taps, const PaddedPlane* derivative, const PaddedPlane& x,
                  const PaddedPlane& y_plane, int y0, int y1, PaddedPlane& gradient) {
  const int width = x.width, stride = x.stride;
  for (int x0 = 0; x0 < width; x0 += kStrip) {
    const int x1 = x0 + kStrip < width ? x0 + kStrip : width;
    for (int y = y0; y < y1; ++y) {
      for (int i = x0; i < x1; i += kLanes) {
        F d[3];
        for (int k = 0; k < 3; ++k) {
          const float* column = derivative[k].row(y) + i;
          const auto at = [&](int o) HWY_ATTR { return load(column + o * stride); };
          d[k] = filter(taps, at);
        }
        const F g = mul_add(F(2.0f) * load(x.row(y) + i), d[1],
                            mul_add(load(y_plane.row(y) + i), d[2], d[0]));
        store(F(0.0f) - columns_inside(i, width, g), gradient.row(y) + i);
      }
    }
  }
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::render::cpu {
HWY_EXPORT(FilterProducts);
HWY_EXPORT(FilterRows);
HWY_EXPORT(MeasuredRow);
HWY_EXPORT(SsimBand);
HWY_EXPORT(GradientBand);

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

/// Calls `body(band, y0, y1)` for the bands of rows [y0, y1) of an image.
template <class Body>
void for_bands(int height, ThreadPool& pool, const Body& body) {
  pool.run((height + kBand - 1) / kBand,
           [&](int band, int) { body(band, band * kBand, std::min(height, (band + 1) * kBand)); });
}
template <class Body>
void for_rows(int height, ThreadPool& pool, const Body& body) {
  for_bands(height, pool, [&](int, int y0, int y1) {
    for (int y = y0; y < y1; ++y) body(y);
  });
}

void match_size(PaddedPlane& plane, int width, int height) {
  if (plane.width != width || plane.height != height) plane = PaddedPlane(width, height);
}

}  // namespace

MeasuredMoments::MeasuredMoments(PaddedPlane channel)
    : y(std::move(channel)), mean(y.width, y.height), variance(y.width, y.height) {
  PaddedPlane m(y.width, y.height), mm(y.width, y.height), unused(y.width, y.height);
  for (int r = 0; r < y.height; ++r) {
    HWY_DYNAMIC_DISPATCH(FilterProducts)
    (kTaps, y.width, y.row(r), y.row(r), m.row(r), mm.row(r), unused.row(r));
  }
  for (int r = 0; r < y.height; ++r) {
    HWY_DYNAMIC_DISPATCH(MeasuredRow)
    (kTaps, y.width, y.stride, m.row(r), mm.row(r), mean.row(r), variance.row(r));
  }
}

void Dssim::reserve(int width, int height) {
  for (auto* planes : {rows_, derivative_}) {
    for (int k = 0; k < 3; ++k) match_size(planes[k], width, height);
  }
  band_values_.resize(static_cast<std::size_t>((height + kBand - 1) / kBand));
}

double Dssim::evaluate(const PaddedPlane& x, const MeasuredMoments& measured, PaddedPlane& gradient,
                       ThreadPool& pool) {
  const int w = x.width, h = x.height;
  reserve(w, h);
  match_size(gradient, w, h);
  for_rows(h, pool, [&](int y) {
    HWY_DYNAMIC_DISPATCH(FilterProducts)
    (kTaps, w, x.row(y), measured.y.row(y), rows_[0].row(y), rows_[1].row(y), rows_[2].row(y));
  });
  for_bands(h, pool, [&](int band, int y0, int y1) {
    band_values_[static_cast<std::size_t>(band)] = HWY_DYNAMIC_DISPATCH(SsimBand)(
        kTaps, rows_, measured.mean, measured.variance, y0, y1, derivative_);
  });
  for_rows(h, pool, [&](int y) {
    const float* const in[3] = {derivative_[0].row(y), derivative_[1].row(y),
                                derivative_[2].row(y)};
    float* const out[3] = {rows_[0].row(y), rows_[1].row(y), rows_[2].row(y)};
    HWY_DYNAMIC_DISPATCH(FilterRows)(kTaps, w, in, out);
  });
  for_bands(h, pool, [&](int, int y0, int y1) {
    HWY_DYNAMIC_DISPATCH(GradientBand)(kTaps, rows_, x, measured.y, y0, y1, gradient);
  });
  double sum = 0;
  for (const double v : band_values_) sum += v;
  return sum;
}

}  // namespace sgs::render::cpu
#endif
