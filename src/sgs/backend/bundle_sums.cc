// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/bundle_sums.h"

#include <algorithm>
#include <limits>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/backend/bundle_sums.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SGS_BACKEND_BUNDLE_SUMS_ONCE
#define SGS_BACKEND_BUNDLE_SUMS_ONCE
namespace sgs::backend {
namespace {

/// Where the sums of one keyframe's pixels are, rows of `width` doubles.
struct HostView {
  double* H;
  double* b;
  double* cross;  // a row per unknown of the calibration
  std::size_t width;
};

}  // namespace
}  // namespace sgs::backend
#endif

HWY_BEFORE_NAMESPACE();
namespace sgs::backend::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 4>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());
constexpr std::size_t kVectors = kBlockStride / kLanes;

/// to += scale * x
HWY_INLINE void AddScaled(const double* x, double scale, double* to) {
  const V factor = hn::Set(kTag, scale);
  for (std::size_t c = 0; c < kBlockStride; c += kLanes) {
    hn::StoreU(hn::MulAdd(factor, hn::LoadU(kTag, x + c), hn::LoadU(kTag, to + c)), kTag, to + c);
  }
}

/// to += scale * x * y^T
HWY_INLINE void AddOuter(const double* x, const double* y, double scale, double* to,
                         std::size_t width) {
  V scaled[kVectors];
  for (std::size_t k = 0; k < kVectors; ++k) {
    scaled[k] = hn::Mul(hn::Set(kTag, scale), hn::LoadU(kTag, y + k * kLanes));
  }
  for (std::size_t r = 0; r < kKeyframeUnknowns; ++r, to += width) {
    const V factor = hn::Set(kTag, x[r]);
    for (std::size_t k = 0; k < kVectors; ++k) {
      double* place = to + k * kLanes;
      hn::StoreU(hn::MulAdd(factor, scaled[k], hn::LoadU(kTag, place)), kTag, place);
    }
  }
}

void AddRows(std::span<const WeightedRow> rows, const HostView& out) {
  for (const WeightedRow& r : rows) {
    if (r.block == 0) continue;
    const std::size_t at = kBlockStride * r.block;
    AddOuter(r.by_host.data(), r.by_host.data(), r.weight, out.H, out.width);
    AddOuter(r.by_host.data(), r.by_target.data(), r.weight, out.H + at, out.width);
    AddOuter(r.by_target.data(), r.by_target.data(), r.weight, out.H + at * out.width + at,
             out.width);
    AddScaled(r.by_host.data(), r.weight * r.residual, out.b);
    AddScaled(r.by_target.data(), r.weight * r.residual, out.b + at);
    if (!r.is_depth) continue;
    for (std::size_t n = 0; n < kTouchedCalibration; ++n) {
      double* cross = out.cross + r.calibration[n] * out.width;
      AddScaled(r.by_host.data(), r.weight * r.by_calibration[n], cross);
      AddScaled(r.by_target.data(), r.weight * r.by_calibration[n], cross + at);
    }
  }
}

/// Schur complement of an inverse depth, as far as keyframes go.
void SubtractEliminated(const Elimination& e, const HostView& out) {
  const double inverse = 1 / e.H;
  const std::size_t blocks = e.blocks.size();
  const double* tail = e.coupling.data() + kBlockStride * blocks;
  for (std::size_t x = 0; x < blocks; ++x) {
    const double* of_x = e.coupling.data() + kBlockStride * x;
    const std::size_t at_x = kBlockStride * e.blocks[x];
    for (std::size_t y = x; y < blocks; ++y) {
      AddOuter(of_x, e.coupling.data() + kBlockStride * y, -inverse,
               out.H + at_x * out.width + kBlockStride * e.blocks[y], out.width);
    }
    for (std::size_t g = 0; g < e.calibration.size(); ++g) {
      AddScaled(of_x, -inverse * tail[g], out.cross + e.calibration[g] * out.width + at_x);
    }
    AddScaled(of_x, -inverse * e.b, out.b + at_x);
  }
}

}  // namespace sgs::backend::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::backend {
HWY_EXPORT(AddRows);
HWY_EXPORT(SubtractEliminated);

namespace {
constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
}  // namespace

BundleSums::BundleSums(std::size_t calibration_unknowns)
    : calibration_H_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(calibration_unknowns),
                                           static_cast<Eigen::Index>(calibration_unknowns))),
      calibration_b_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(calibration_unknowns))),
      place_(calibration_unknowns, kNowhere) {}

void BundleSums::begin() {
  calibration_H_.setZero();
  calibration_b_.setZero();
}

void BundleSums::begin_host(std::size_t blocks) {
  width_ = kBlockStride * blocks;
  H_.assign(width_ * width_, 0);
  b_.assign(width_, 0);
  cross_.assign(width_ * place_.size(), 0);
}

// Which unknowns the rows of a pixel touch.
void BundleSums::start_elimination(std::span<const WeightedRow> rows, Elimination& e) {
  e.H = e.b = 0;
  e.blocks.assign(1, 0);
  e.calibration.clear();
  for (const WeightedRow& r : rows) {
    if (r.block > e.blocks.back()) e.blocks.push_back(r.block);
    if (!r.is_depth) continue;
    for (const std::size_t unknown : r.calibration) {
      if (place_[unknown] != kNowhere) continue;
      place_[unknown] = e.calibration.size();
      e.calibration.push_back(unknown);
    }
  }
  const std::size_t of_blocks = kBlockStride * e.blocks.size();
  e.coupling.assign(of_blocks + e.calibration.size(), 0);
  std::size_t seen = 0;
  for (const WeightedRow& r : rows) {
    while (e.blocks[seen] != r.block) ++seen;
    const double coupling = r.weight * r.by_inverse_depth;
    e.H += coupling * r.by_inverse_depth;
    e.b += coupling * r.residual;
    for (std::size_t k = 0; r.block != 0 && k < kBlockStride; ++k) {
      e.coupling[k] += coupling * r.by_host[k];
      e.coupling[kBlockStride * seen + k] += coupling * r.by_target[k];
    }
    for (std::size_t n = 0; r.is_depth && n < kTouchedCalibration; ++n) {
      e.coupling[of_blocks + place_[r.calibration[n]]] += coupling * r.by_calibration[n];
    }
  }
  for (const std::size_t unknown : e.calibration) place_[unknown] = kNowhere;
}

void BundleSums::add_calibration(std::span<const WeightedRow> rows, Elimination& e) {
  const auto add = [this](std::size_t g, std::size_t h, double value) {
    const auto [low, high] = std::minmax(g, h);
    calibration_H_(static_cast<Eigen::Index>(low), static_cast<Eigen::Index>(high)) += value;
  };
  for (const WeightedRow& r : rows) {
    if (!r.is_depth) continue;
    for (std::size_t n = 0; n < kTouchedCalibration; ++n) {
      const double weighted = r.weight * r.by_calibration[n];
      calibration_b_[static_cast<Eigen::Index>(r.calibration[n])] += weighted * r.residual;
      for (std::size_t m = 0; m <= n; ++m) {
        // Nodes at the border may be one and the same: then the product stands twice.
        const bool same = m != n && r.calibration[m] == r.calibration[n];
        add(r.calibration[n], r.calibration[m], (same ? 2 : 1) * weighted * r.by_calibration[m]);
      }
    }
  }
  const double* tail = e.coupling.data() + kBlockStride * e.blocks.size();
  for (std::size_t n = 0; n < e.calibration.size(); ++n) {
    const double scaled = -tail[n] / e.H;
    calibration_b_[static_cast<Eigen::Index>(e.calibration[n])] += scaled * e.b;
    for (std::size_t m = 0; m <= n; ++m) {
      add(e.calibration[n], e.calibration[m], scaled * tail[m]);
    }
  }
}

void BundleSums::add_pixel(std::span<const WeightedRow> rows, Elimination& e) {
  start_elimination(rows, e);
  if (e.H <= 0) return;
  const HostView out{H_.data(), b_.data(), cross_.data(), width_};
  HWY_DYNAMIC_DISPATCH(AddRows)(rows, out);
  HWY_DYNAMIC_DISPATCH(SubtractEliminated)(e, out);
  add_calibration(rows, e);
}

Eigen::Matrix<double, kKeyframeUnknowns, kKeyframeUnknowns> BundleSums::H(std::size_t a,
                                                                          std::size_t b) const {
  Eigen::Matrix<double, kKeyframeUnknowns, kKeyframeUnknowns> out;
  for (std::size_t r = 0; r < kKeyframeUnknowns; ++r) {
    const double* row = H_.data() + (kBlockStride * a + r) * width_ + kBlockStride * b;
    out.row(static_cast<Eigen::Index>(r)) =
        Eigen::Map<const Eigen::RowVectorXd>(row, kKeyframeUnknowns);
  }
  return out;
}

KeyframeVector BundleSums::b(std::size_t block) const {
  return Eigen::Map<const KeyframeVector>(b_.data() + kBlockStride * block);
}

KeyframeVector BundleSums::cross(std::size_t block, std::size_t unknown) const {
  return Eigen::Map<const KeyframeVector>(cross_.data() + unknown * width_ + kBlockStride * block);
}

}  // namespace sgs::backend
#endif
