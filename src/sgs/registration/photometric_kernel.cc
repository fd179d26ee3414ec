// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/photometric_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/registration/photometric_kernel.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h, whose target it is compiled for.
#include <hwy/contrib/math/math-inl.h>

#ifndef SGS_REGISTRATION_PHOTOMETRIC_KERNEL_ONCE
#define SGS_REGISTRATION_PHOTOMETRIC_KERNEL_ONCE
namespace sgs::registration {
namespace {

constexpr std::size_t kBlock = 256;  // points per float sum: all columns stay in the first cache
constexpr float kNearPlane_m = 0.1f;
constexpr int kColumns = kPhotometricUnknowns + 1;  // the residual is one more column

struct alignas(64) Column {
  float values[kBlock];
};

// One block of points on its way through the passes, structure of arrays.
struct Block {
  Column x, y, z, u, v, row_offset, reference;  // of the points, then of those that are used
  Column intensity, gx, gy;
  Column weight;
  std::array<Column, kColumns> J;  // Jacobian, then residual
  std::size_t used = 0;
};

}  // namespace
}  // namespace sgs::registration
#endif

HWY_BEFORE_NAMESPACE();
namespace sgs::registration::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

HWY_INLINE V constant(float value) { return hn::Set(kTag, value); }
HWY_INLINE V load(const Column& c, std::size_t i) { return hn::Load(kTag, c.values + i); }
HWY_INLINE void store(V value, Column& c, std::size_t i) { hn::Store(value, kTag, c.values + i); }
HWY_INLINE V dot3(V a0, V b0, V a1, V b1, V a2, V b2) {
  return hn::MulAdd(a0, b0, hn::MulAdd(a1, b1, hn::Mul(a2, b2)));
}
HWY_INLINE V difference_of_products(V a, V b, V c, V d) {
  return hn::NegMulAdd(c, d, hn::Mul(a, b));
}

// Pass 1: where the current camera sees the points. Pixels that are not inside come out negative.
HWY_NOINLINE void ProjectPoints(const PhotometricView& view, const PhotometricPoint* points,
                                std::size_t count, Block& block) {
  const PinholeCamera& camera = view.image->camera;
  const auto f = [](double x) { return constant(static_cast<float>(x)); };
  const V fx = f(camera.fx), fy = f(camera.fy), cx = f(camera.cx), cy = f(camera.cy);
  const V max_u = f(camera.width - 3), max_v = f(camera.height - 3), low = constant(2.0f);
  const V one = constant(1.0f), half = constant(0.5f);
  const V per_row = f(1.0 / camera.height);
  const Eigen::Vector3f w = view.readout.rotation(), s = view.readout.translation();
  const auto r = [&](int i, int k) { return constant(view.R(i, k)); };
  for (std::size_t i = 0; i < count; i += kLanes) {
    PhotometricPoint tail[kLanes];
    const PhotometricPoint* p = points + i;
    if (count - i < kLanes) {  // the last few: repeat the last point, its lanes are not used
      for (std::size_t l = 0; l < kLanes; ++l) tail[l] = points[std::min(i + l, count - 1)];
      p = tail;
    }
    V px, py, pz, grey;
    hn::LoadInterleaved4(kTag, p->p_keyframe.data(), px, py, pz, grey);
    const V mx = hn::Add(dot3(r(0, 0), px, r(0, 1), py, r(0, 2), pz), constant(view.t.x()));
    const V my = hn::Add(dot3(r(1, 0), px, r(1, 1), py, r(1, 2), pz), constant(view.t.y()));
    const V mz = hn::Add(dot3(r(2, 0), px, r(2, 1), py, r(2, 2), pz), constant(view.t.z()));
    const auto in_front = hn::Gt(mz, constant(kNearPlane_m));
    const V safe_z = hn::IfThenElse(in_front, mz, one);
    // The row that sees the point follows from where the middle row's camera would: the readout
    // moves it by a pixel or two, a negligible part of the picture's height.
    const V row = hn::MulAdd(hn::Div(my, safe_z), fy, cy);
    const V place = hn::Sub(hn::Mul(hn::Add(row, half), per_row), half);
    const V o = hn::Min(hn::Max(place, constant(-0.5f)), half);
    const V turn_x = difference_of_products(constant(w.y()), mz, constant(w.z()), my);
    const V turn_y = difference_of_products(constant(w.z()), mx, constant(w.x()), mz);
    const V turn_z = difference_of_products(constant(w.x()), my, constant(w.y()), mx);
    const V x = hn::NegMulAdd(o, hn::Add(turn_x, constant(s.x())), mx);
    const V y = hn::NegMulAdd(o, hn::Add(turn_y, constant(s.y())), my);
    const V z = hn::NegMulAdd(o, hn::Add(turn_z, constant(s.z())), mz);
    const V inverse_z = hn::Div(one, z);
    const V u = hn::MulAdd(hn::Mul(x, inverse_z), fx, cx);
    const V v = hn::MulAdd(hn::Mul(y, inverse_z), fy, cy);
    const auto inside_u = hn::And(hn::Ge(u, low), hn::Lt(u, max_u));
    const auto inside_v = hn::And(hn::Ge(v, low), hn::Lt(v, max_v));
    const auto inside = hn::And(in_front, hn::And(inside_u, inside_v));
    store(x, block.x, i);
    store(y, block.y, i);
    store(z, block.z, i);
    store(hn::IfThenElse(inside, u, constant(-1.0f)), block.u, i);
    store(v, block.v, i);
    store(o, block.row_offset, i);
    store(grey, block.reference, i);
  }
}

// Pass 2, point by point: drops what is outside or hidden, closes the gaps and looks the rest up.
HWY_NOINLINE int LookUp(const PhotometricView& view, std::size_t count, Block& block,
                        PhotometricSums& sums) {
  const DepthImage& depth = *view.depth;
  const float full = static_cast<float>(1 << view.level);
  const int last_u = depth.width() - 1, last_v = depth.height() - 1;
  int visible = 0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = block.u.values[i], v = block.v.values[i], z = block.z.values[i];
    if (u < 0) continue;
    ++visible;
    const int du = std::min(static_cast<int>((u + 0.5f) * full), last_u);
    const int dv = std::min(static_cast<int>((v + 0.5f) * full), last_v);
    const float measured = depth(du, dv);
    if (view.moving != nullptr) {
      const float gate = view.depth_gate_m + view.depth_gate_ratio * z;
      const bool moves = view.moving->at(du, dv);
      if (moves || measured - z > gate) ++sums.gone;
      if (moves) continue;
    }
    if (measured > 0 && std::abs(measured - z) > view.depth_gate_m + view.depth_gate_ratio * z) {
      continue;
    }
    const GraySample s = view.image->interpolate(u, v);
    if (std::isnan(s.intensity + s.gx + s.gy)) continue;  // the camera did not see it
    block.x.values[used] = block.x.values[i];
    block.y.values[used] = block.y.values[i];
    block.z.values[used] = z;
    block.row_offset.values[used] = block.row_offset.values[i];
    block.reference.values[used] = block.reference.values[i];
    block.intensity.values[used] = s.intensity;
    block.gx.values[used] = s.gx;
    block.gy.values[used] = s.gy;
    ++used;
  }
  block.used = used;
  for (; used % kLanes != 0; ++used) {  // harmless values where the last vector is not full
    block.x.values[used] = block.y.values[used] = block.row_offset.values[used] = 0;
    block.z.values[used] = 1;
    block.reference.values[used] = block.intensity.values[used] = 0;
    block.gx.values[used] = block.gy.values[used] = 0;
  }
  return visible;
}

// Pass 3: residuals, weights and Jacobian. Adds up ln(1 + e^2 / nu) and weighted squares.
HWY_NOINLINE void Differentiate(const PhotometricView& view, Block& block, PhotometricSums& sums) {
  const PinholeCamera& camera = view.image->camera;
  const V fx = constant(static_cast<float>(camera.fx)),
          fy = constant(static_cast<float>(camera.fy));
  const V gain = constant(view.gain), offset = constant(view.offset);
  const V information = constant(view.inverse_variance), nu = constant(view.t_dof);
  const V inverse_nu = constant(1 / view.t_dof), top = constant(view.t_dof + 1);
  V log_sum = hn::Zero(kTag), square_sum = hn::Zero(kTag);
  for (std::size_t i = 0; i < block.used; i += kLanes) {
    const auto counts = hn::FirstN(kTag, std::min(kLanes, block.used - i));
    const V x = load(block.x, i), y = load(block.y, i), z = load(block.z, i);
    const V reference = load(block.reference, i), o = load(block.row_offset, i);
    const V residual = hn::Sub(hn::NegMulAdd(gain, reference, load(block.intensity, i)), offset);
    const V e2 = hn::Mul(hn::Mul(residual, residual), information);
    log_sum =
        hn::Add(log_sum, hn::IfThenElseZero(counts, hn::Log1p(kTag, hn::Mul(e2, inverse_nu))));
    const V robust = hn::Div(top, hn::Add(nu, e2));
    square_sum = hn::Add(square_sum, hn::IfThenElseZero(counts, hn::Mul(robust, e2)));
    const V weight = hn::Mul(robust, information);
    const V inverse_z = hn::Div(constant(1.0f), z);
    const V gX = hn::Mul(hn::Mul(load(block.gx, i), fx), inverse_z);
    const V gY = hn::Mul(hn::Mul(load(block.gy, i), fy), inverse_z);
    const V gZ = hn::Neg(hn::Mul(hn::MulAdd(gX, x, hn::Mul(gY, y)), inverse_z));
    const V turn_x = difference_of_products(gY, z, gZ, y);
    const V turn_y = difference_of_products(gZ, x, gX, z);
    const V turn_z = difference_of_products(gX, y, gY, x);
    store(hn::IfThenElseZero(counts, weight), block.weight, i);
    store(turn_x, block.J[0], i);
    store(turn_y, block.J[1], i);
    store(turn_z, block.J[2], i);
    store(hn::Neg(gX), block.J[3], i);
    store(hn::Neg(gY), block.J[4], i);
    store(hn::Neg(gZ), block.J[5], i);
    store(hn::Mul(o, turn_x), block.J[6], i);
    store(hn::Mul(o, turn_y), block.J[7], i);
    store(hn::Mul(o, turn_z), block.J[8], i);
    store(hn::Neg(reference), block.J[9], i);
    store(constant(-1.0f), block.J[10], i);
    store(residual, block.J[11], i);
  }
  sums.log_sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(kTag, log_sum)));
  sums.square_sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(kTag, square_sum)));
}

// Pass 4: weighted products of a column with up to four others, added to `out`.
HWY_INLINE void MultiplyColumns(const Block& block, const int* columns, int a, int first, int count,
                                double (&out)[4]) {
  const auto column = [&](int k) -> const Column& {
    return block.J[static_cast<std::size_t>(columns[std::min(first + k, count - 1)])];
  };
  const Column& left = block.J[static_cast<std::size_t>(columns[a])];
  const Column &c0 = column(0), &c1 = column(1), &c2 = column(2), &c3 = column(3);
  V s0 = hn::Zero(kTag), s1 = s0, s2 = s0, s3 = s0;
  for (std::size_t i = 0; i < block.used; i += kLanes) {
    const V w = hn::Mul(load(block.weight, i), load(left, i));
    s0 = hn::MulAdd(w, load(c0, i), s0);
    s1 = hn::MulAdd(w, load(c1, i), s1);
    s2 = hn::MulAdd(w, load(c2, i), s2);
    s3 = hn::MulAdd(w, load(c3, i), s3);
  }
  const auto sum = [](V s) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(kTag, s))); };
  out[0] = sum(s0);
  out[1] = sum(s1);
  out[2] = sum(s2);
  out[3] = sum(s3);
}

HWY_NOINLINE void AddProducts(const PhotometricView& view, const Block& block,
                              PhotometricSums& sums) {
  static constexpr int kAll[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  static constexpr int kWithoutReadout[] = {0, 1, 2, 3, 4, 5, 9, 10, 11};
  const int* columns = view.with_readout ? kAll : kWithoutReadout;
  const int count = view.with_readout ? kColumns : kColumns - kPhotometricReadout;
  for (int a = 0; a + 1 < count; ++a) {
    for (int c = a; c < count; c += 4) {
      double products[4];
      MultiplyColumns(block, columns, a, c, count, products);
      for (int k = 0; k < 4 && c + k < count; ++k) {
        const int column = columns[c + k];
        if (column == kPhotometricUnknowns) {
          sums.b(columns[a]) += products[k];
        } else {
          sums.H(columns[a], column) += products[k];
        }
      }
    }
  }
}

PhotometricSums SumPhotometric(const PhotometricView& view,
                               std::span<const PhotometricPoint> points) {
  PhotometricSums sums;
  Block block;
  for (std::size_t begin = 0; begin < points.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - begin);
    ProjectPoints(view, points.data() + begin, count, block);
    sums.visible += LookUp(view, count, block, sums);
    sums.used += static_cast<int>(block.used);
    Differentiate(view, block, sums);
    AddProducts(view, block, sums);
  }
  sums.H.triangularView<Eigen::StrictlyLower>() = sums.H.transpose();
  return sums;
}

}  // namespace sgs::registration::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::registration {
HWY_EXPORT(SumPhotometric);

PhotometricSums sum_photometric(const PhotometricView& view,
                                std::span<const PhotometricPoint> points) {
  return HWY_DYNAMIC_DISPATCH(SumPhotometric)(view, points);
}

}  // namespace sgs::registration
#endif
