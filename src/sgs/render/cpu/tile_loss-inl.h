// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Value and gradient of the per-pixel losses (LossConfig), block by block.

#if defined(SGS_RENDER_CPU_TILE_LOSS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SGS_RENDER_CPU_TILE_LOSS_INL_H_
#undef SGS_RENDER_CPU_TILE_LOSS_INL_H_
#else
#define SGS_RENDER_CPU_TILE_LOSS_INL_H_
#endif

#include "sgs/render/cpu/tile_forward-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::render::cpu::HWY_NAMESPACE {

struct LossSums {
  F loss, measured[3], rendered[3];
};

/// |e| with its tip rounded off below `knee` > 0 (Huber 1964), and the slope of that.
struct RoundedAbs {
  F knee, inverse;
  explicit HWY_INLINE RoundedAbs(float width) : knee(width), inverse(1.0f / width) {}
  HWY_INLINE F value(F e) const {
    const F a = absolute(e), c = minimum(a, knee);
    return c * inverse * neg_mul_add(F(0.5f), c, a);
  }
  HWY_INLINE F slope(F e) const { return maximum(minimum(e * inverse, F(1.0f)), F(-1.0f)); }
};

/// `inside` tells which pixels belong to the image.
HWY_INLINE void loss_part(const TileLoss& loss, const BlockState& state, const float* training,
                          const float* color_gradient, Mask inside, int part, BlockGradient& out,
                          LossSums& sums) {
  const int at = part * kLanes;
  const F zero(0.0f);
  const RoundedAbs color_loss(loss.color_knee), depth_loss(loss.depth_knee_m);
  const F z = load(training + 3 * kBlockPixels + at);
  const F depth = load(state.d + at), alpha = load(state.a + at);
  const Mask measured = hn::And(inside, z > zero);
  const Mask seen = hn::And(inside, z >= zero);
  const F color_weight =
      zero_unless(loss.color_only_where_depth ? measured : seen, F(loss.color_weight));
  const Mask explained = hn::And(measured, alpha > F(0.9f));
  const float* const rendered[3] = {state.r, state.g, state.b};
  float* const gradient[3] = {out.r, out.g, out.b};
  F behind = zero;
  for (int c = 0; c < 3; ++c) {
    const F x = load(rendered[c] + at), y = load(training + c * kBlockPixels + at);
    const F gain(loss.gain[c]);
    const F e = gain * x - y;
    F g = color_weight * gain * color_loss.slope(e);
    sums.loss = mul_add(color_weight, color_loss.value(e), sums.loss);
    if (color_gradient != nullptr) {
      g = g + zero_unless(seen, load(color_gradient + c * kBlockPixels + at));
    }
    store(g, gradient[c] + at);
    behind = mul_add(g, x, behind);
    const Mask exposed = hn::And(explained, hn::And(y > F(0.02f), y < F(0.97f)));
    sums.measured[c] = sums.measured[c] + zero_unless(exposed, y);
    sums.rendered[c] = sums.rendered[c] + zero_unless(exposed, x);
  }
  F e, weight = F(loss.depth_weight), ga = zero;
  if (loss.depth_relative) {
    e = neg_mul_add(alpha, z, depth);
    weight = weight / maximum(z, F(0.3f));
  } else {
    e = depth - z;
  }
  weight = zero_unless(measured, weight);
  const F gd = weight * depth_loss.slope(e);
  if (loss.depth_relative) ga = zero - z * gd;
  sums.loss = mul_add(weight, depth_loss.value(e), sums.loss);
  store(gd, out.d + at);
  store(ga, out.a + at);
  store(F(1.0f), out.T + at);
  store(mul_add(gd, depth, mul_add(ga, alpha, behind)), out.S + at);
  store(zero_unless(measured, z - F(loss.floater_margin_m)), out.nearest_z + at);
}

}  // namespace sgs::render::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
