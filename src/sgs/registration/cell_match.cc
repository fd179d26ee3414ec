// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/cell_match.h"

#include <algorithm>
#include <cstdint>

#include "sgs/core/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/registration/cell_match.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sgs::registration::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 4>;  // three neighbours and one lane that is ignored
using IntTag = hn::RebindToSigned<Tag>;
using V = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr IntTag kInt;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Tag()));
constexpr int kSide = 3;  // cells around the centre, itself included

HWY_INLINE V dot(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

HWY_INLINE int NearestAround(const CellTargets& targets, const CellGates& gates, int centre,
                             const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  const V x = hn::Set(kTag, point.x()), y = hn::Set(kTag, point.y()), z = hn::Set(kTag, point.z());
  const V nx = hn::Set(kTag, normal.x()), ny = hn::Set(kTag, normal.y()),
          nz = hn::Set(kTag, normal.z());
  const V min_cosine = hn::Set(kTag, gates.min_cosine);
  float best_distance2 = gates.max_distance2;
  int best_cell = -1;
  for (int column = 0; column < kSide; column += kLanes) {
    V best = hn::Set(kTag, best_distance2);
    auto cells = hn::Set(kInt, -1);
    for (int row = 0; row < kSide; ++row) {
      const int first = centre + (row - 1) * targets.width() + column - 1;
      const V dx = hn::Sub(hn::LoadU(kTag, targets.point(0) + first), x);
      const V dy = hn::Sub(hn::LoadU(kTag, targets.point(1) + first), y);
      const V dz = hn::Sub(hn::LoadU(kTag, targets.point(2) + first), z);
      const V distance2 = dot(dx, dy, dz, dx, dy, dz);
      const V cosine = dot(hn::LoadU(kTag, targets.normal(0) + first),
                           hn::LoadU(kTag, targets.normal(1) + first),
                           hn::LoadU(kTag, targets.normal(2) + first), nx, ny, nz);
      const auto better = hn::And(hn::Lt(distance2, best), hn::Gt(cosine, min_cosine));
      best = hn::IfThenElse(better, distance2, best);
      cells = hn::IfThenElse(hn::RebindMask(kInt, better), hn::Iota(kInt, first), cells);
    }
    alignas(16) float distances2[kLanes];
    alignas(16) std::int32_t candidates[kLanes];
    hn::Store(best, kTag, distances2);
    hn::Store(cells, kInt, candidates);
    for (int l = 0; l < kLanes && column + l < kSide; ++l) {
      if (candidates[l] < 0 || !(distances2[l] < best_distance2)) continue;
      best_distance2 = distances2[l];
      best_cell = candidates[l];
    }
  }
  return best_cell;
}

void MatchCells(const CellTargets& targets, const CellCamera& camera, const CellGates& gates,
                const Eigen::Matrix3f& R, const Eigen::Vector3f& t,
                std::span<const SourcePoint> points, std::span<int> cells) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = R * points[i].point + t;
    const int centre = cell_of(camera, targets.width(), targets.height(), p);
    cells[i] = centre < 0 ? -1 : NearestAround(targets, gates, centre, p, R * points[i].normal);
  }
}

using Wide = hn::CappedTag<float, 16>;

// Cells and depths of one vector of points; p and n: coordinates and normals.
template <class D, class Vec>
HWY_INLINE void ProjectVector(D d, const Vec (&p)[3], const Vec (&n)[3], const CellCamera& camera,
                              int width, int height, const Eigen::Matrix3f& R,
                              const Eigen::Vector3f& t, const Eigen::Vector3f& eye, int* cells,
                              float* depths) {
  const hn::RebindToSigned<D> di;
  const auto moved = [&](int row) {
    return hn::MulAdd(hn::Set(d, R(row, 0)), p[0],
                      hn::MulAdd(hn::Set(d, R(row, 1)), p[1],
                                 hn::MulAdd(hn::Set(d, R(row, 2)), p[2], hn::Set(d, t[row]))));
  };
  const auto from_eye = [&](int axis) { return hn::Sub(p[axis], hn::Set(d, eye[axis])); };
  const auto away =
      hn::MulAdd(n[0], from_eye(0), hn::MulAdd(n[1], from_eye(1), hn::Mul(n[2], from_eye(2))));
  const auto x = moved(0), y = moved(1), z = moved(2);
  const auto one = hn::Set(d, 1.0f);
  const auto in_front = hn::Gt(z, hn::Set(d, camera.near_m));
  const auto inverse = hn::Div(one, hn::IfThenElse(in_front, z, one));
  const auto u = hn::MulAdd(hn::Mul(x, inverse), hn::Set(d, camera.fx), hn::Set(d, camera.cx));
  const auto v = hn::MulAdd(hn::Mul(y, inverse), hn::Set(d, camera.fy), hn::Set(d, camera.cy));
  const auto inside_u =
      hn::And(hn::Ge(u, one), hn::Lt(u, hn::Set(d, static_cast<float>(width - 1))));
  const auto inside_v =
      hn::And(hn::Ge(v, one), hn::Lt(v, hn::Set(d, static_cast<float>(height - 1))));
  const auto facing = hn::Lt(away, hn::Zero(d));
  const auto inside = hn::And(hn::And(in_front, facing), hn::And(inside_u, inside_v));
  const auto column = hn::ConvertTo(di, hn::IfThenElse(inside, u, one));
  const auto row = hn::ConvertTo(di, hn::IfThenElse(inside, v, one));
  const auto cell = hn::Add(hn::Mul(row, hn::Set(di, width)), column);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(di, inside), cell, hn::Set(di, -1)), di, cells);
  hn::StoreU(z, d, depths);
}

void ProjectToCells(const PointArrays& points, const CellCamera& camera, int width, int height,
                    const Eigen::Matrix3f& R, const Eigen::Vector3f& t, int* cells, float* depths) {
  constexpr Wide d;
  constexpr std::size_t kWide = hn::MaxLanes(Wide());
  const Eigen::Vector3f eye = -(R.transpose() * t);
  const auto project = [&](auto tag, std::size_t i) {
    const auto load = [&](const float* const(&arrays)[3], int axis) {
      return hn::LoadU(tag, arrays[axis] + i);
    };
    const hn::Vec<decltype(tag)> p[3] = {load(points.point, 0), load(points.point, 1),
                                         load(points.point, 2)};
    const hn::Vec<decltype(tag)> n[3] = {load(points.normal, 0), load(points.normal, 1),
                                         load(points.normal, 2)};
    ProjectVector(tag, p, n, camera, width, height, R, t, eye, cells + i, depths + i);
  };
  std::size_t i = 0;
  for (; i + kWide <= points.count; i += kWide) project(d, i);
  for (; i < points.count; ++i) project(hn::CappedTag<float, 1>(), i);
}

}  // namespace sgs::registration::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::registration {
HWY_EXPORT(MatchCells);
HWY_EXPORT(ProjectToCells);

CellTargets::CellTargets(int width, int height) : width_(width), height_(height) {
  constexpr std::size_t kOverhang = 4;
  const auto cells = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (auto& array : arrays_) array.assign(cells + kOverhang, kEmpty);
}

// The normals of empty cells do not matter.
void CellTargets::clear() {
  for (int axis = 0; axis < 3; ++axis) {
    std::fill(arrays_[axis].begin(), arrays_[axis].end(), kEmpty);
  }
}

void CellTargets::set(int cell, const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  const auto i = static_cast<std::size_t>(cell);
  for (int axis = 0; axis < 3; ++axis) {
    arrays_[axis][i] = point[axis];
    arrays_[3 + axis][i] = normal[axis];
  }
}

void match_cells(const CellTargets& targets, const CellCamera& camera, const CellGates& gates,
                 const Eigen::Matrix3f& R, const Eigen::Vector3f& t,
                 std::span<const SourcePoint> points, std::span<int> cells) {
  HWY_DYNAMIC_DISPATCH(MatchCells)(targets, camera, gates, R, t, points, cells);
}

void project_to_cells(const PointArrays& points, const CellCamera& camera, int width, int height,
                      const Eigen::Matrix3f& R, const Eigen::Vector3f& t, int* cells,
                      float* depths) {
  HWY_DYNAMIC_DISPATCH(ProjectToCells)(points, camera, width, height, R, t, cells, depths);
}

}  // namespace sgs::registration
#endif
