// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/pixel_selection.h"

#include <algorithm>
#include <cstdint>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/registration/pixel_selection.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SGS_REGISTRATION_PIXEL_SELECTION_ONCE
#define SGS_REGISTRATION_PIXEL_SELECTION_ONCE
namespace sgs::registration {
namespace {

// Neighbouring rows of a picture, and the depths beside the middle one.
struct PixelRows {
  const float *above, *row, *below, *depths;
  float max_depth_m;
};

// Steepest pixel of each column so far: squared gradient and row.
struct SteepestRows {
  std::vector<float> gradient2;
  std::vector<std::int32_t> y;
};

}  // namespace
}  // namespace sgs::registration
#endif

HWY_BEFORE_NAMESPACE();
namespace sgs::registration::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;

template <class D>
HWY_INLINE void KeepSteepestAt(D d, const PixelRows& rows, int y, int x, SteepestRows& steepest) {
  const hn::RebindToSigned<D> di;
  const auto half = hn::Set(d, 0.5f);
  const auto gx =
      hn::Mul(half, hn::Sub(hn::LoadU(d, rows.row + x + 1), hn::LoadU(d, rows.row + x - 1)));
  const auto gy =
      hn::Mul(half, hn::Sub(hn::LoadU(d, rows.below + x), hn::LoadU(d, rows.above + x)));
  // No fused operation: the same pixels for any instruction set.
  const auto g2 = hn::Add(hn::Mul(gx, gx), hn::Mul(gy, gy));
  const auto z = hn::LoadU(d, rows.depths + x);
  float* best = steepest.gradient2.data() + x;
  std::int32_t* where = steepest.y.data() + x;
  const auto before = hn::LoadU(d, best);
  const auto steeper = hn::And(
      hn::And(hn::Gt(z, hn::Set(d, kNearestPixel_m)), hn::Lt(z, hn::Set(d, rows.max_depth_m))),
      hn::Gt(g2, before));
  hn::StoreU(hn::IfThenElse(steeper, g2, before), d, best);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(di, steeper), hn::Set(di, y), hn::LoadU(di, where)), di,
             where);
}

void KeepSteepest(const PixelRows& rows, int y, int width, SteepestRows& steepest) {
  constexpr Tag d;
  constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));
  int x = 1;
  for (; x + kLanes < width; x += kLanes) KeepSteepestAt(d, rows, y, x, steepest);
  for (; x < width - 1; ++x) KeepSteepestAt(hn::CappedTag<float, 1>(), rows, y, x, steepest);
}

}  // namespace sgs::registration::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::registration {
HWY_EXPORT(KeepSteepest);

int full_pixel(int level_coordinate, int level, int size) {
  // (x + 1/2) 2^level, rounded down.
  const int full = ((2 * level_coordinate + 1) << level) / 2;
  return std::min(full, size - 1);
}

std::vector<SelectedPixel> select_pixels(const Image<float>& gray, int level,
                                         const DepthImage& depth, const PhotometricConfig& config) {
  constexpr int kMargin = 2;
  const int block = config.block_at(level), width = gray.width();
  const auto threshold = static_cast<float>(config.gradient_threshold_at(level));
  const auto columns = static_cast<std::size_t>(width);
  std::vector<float> depths(columns);
  SteepestRows steepest;
  std::vector<SelectedPixel> out;
  for (int y0 = kMargin; y0 + block < gray.height() - kMargin; y0 += block) {
    steepest.gradient2.assign(columns, threshold * threshold);
    steepest.y.assign(columns, -1);
    for (int y = y0; y < y0 + block; ++y) {
      const float* full = depth.row(full_pixel(y, level, depth.height()));
      for (int x = 0; x < width && level > 0; ++x) {
        depths[static_cast<std::size_t>(x)] = full[full_pixel(x, level, depth.width())];
      }
      const PixelRows rows = {gray.row(y - 1), gray.row(y), gray.row(y + 1),
                              level > 0 ? depths.data() : full,
                              static_cast<float>(config.max_depth_m)};
      HWY_DYNAMIC_DISPATCH(KeepSteepest)(rows, y, width, steepest);
    }
    for (int x0 = kMargin; x0 + block < width - kMargin; x0 += block) {
      const auto begin = steepest.gradient2.begin() + x0;
      const auto x = std::max_element(begin, begin + block) - steepest.gradient2.begin();
      const std::int32_t y = steepest.y[static_cast<std::size_t>(x)];
      if (y >= 0) out.push_back({static_cast<int>(x), y});
    }
  }
  return out;
}

}  // namespace sgs::registration
#endif
