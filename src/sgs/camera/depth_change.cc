// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_change.h"

#include <cmath>

#include "sgs/core/error.h"

namespace sgs {
namespace {

constexpr double kNearest_per_m = 50, kFarthest_per_m = 0.01;

Eigen::Vector2d pixel_of(const PinholeCamera& c, const Eigen::Vector3d& p) {
  return {c.fx * p.x() / p.z() + c.cx, c.fy * p.y() / p.z() + c.cy};
}

}  // namespace

DepthChange::DepthChange(const DepthCalibration& before, const DepthCalibration& after)
    : after_(after), difference_(after) {
  difference_.shift_px = after.shift_px - before.shift_px;
  if (before.offset_per_m.empty()) return;
  SGS_CHECK(after.offset_per_m.empty() || before.grid == after.grid, "grids differ");
  difference_.grid = before.grid;
  difference_.offset_per_m.resize(before.offset_per_m.size(), 0.0);
  for (std::size_t k = 0; k < before.offset_per_m.size(); ++k) {
    difference_.offset_per_m[k] -= before.offset_per_m[k];
  }
}

DepthChange DepthChange::halved(int level) const {
  DepthChange out = *this;
  for (DepthCalibration* c : {&out.after_, &out.difference_}) {
    c->camera = c->camera.halved(level);
    c->shift_px /= 1 << level;
  }
  return out;
}

double DepthChange::rms_per_m() const {
  if (difference_.offset_per_m.empty()) return 0;
  const std::vector<double> area = difference_.grid.area();
  double square = 0;
  for (std::size_t k = 0; k < area.size(); ++k) {
    square += area[k] * difference_.offset_per_m[k] * difference_.offset_per_m[k];
  }
  return std::sqrt(square);
}

double DepthChange::changed(const Eigen::Vector2d& pixel, double q,
                            const Eigen::Vector2d& slope) const {
  const Eigen::Vector2d from = pixel - difference_.shift_px;
  return q - slope.dot(difference_.shift_px) + difference_.offset_at(from.x(), from.y());
}

Eigen::Vector2d DepthChange::slope_change(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d from = pixel - difference_.shift_px;
  const double here = difference_.offset_at(from.x(), from.y());
  return {difference_.offset_at(from.x() + 1, from.y()) - here,
          difference_.offset_at(from.x(), from.y() + 1) - here};
}

void DepthChange::apply(Eigen::Vector3f& point, Eigen::Vector3f& normal) const {
  // At flat incidence a plane's slope says more about the noise of its normal than about depth.
  constexpr double kFlattest = 0.15;
  const PinholeCamera& c = difference_.camera;
  const Eigen::Vector3d p = point.cast<double>(), n = normal.cast<double>();
  if (!(p.z() > 0)) return;
  const Eigen::Vector3d ray = p / p.z();
  const double facing = n.dot(ray);  // the plane: q = n . ray' / (facing z)
  if (std::abs(facing) < kFlattest * ray.norm()) {
    apply(point, Eigen::Vector2f(Eigen::Vector2f::Zero()));
    return;
  }
  const double per_q = 1 / (facing * p.z());
  Eigen::Vector2d slope(n.x() * per_q / c.fx, n.y() * per_q / c.fy);
  const Eigen::Vector2d pixel = pixel_of(c, p);
  const double q = changed(pixel, 1 / p.z(), slope);
  if (!(q > kFarthest_per_m && q < kNearest_per_m)) return;
  slope += slope_change(pixel);
  point = (ray / q).cast<float>();
  Eigen::Vector3d turned(slope.x() * c.fx, slope.y() * c.fy, 0);
  turned.z() = q - turned.x() * ray.x() - turned.y() * ray.y();
  turned.normalize();
  normal = (turned.dot(n) < 0 ? Eigen::Vector3d(-turned) : turned).cast<float>();
}

void DepthChange::apply(Eigen::Vector3f& point, const Eigen::Vector2f& slope) const {
  const Eigen::Vector3d p = point.cast<double>();
  if (!(p.z() > 0)) return;
  const double q = changed(pixel_of(difference_.camera, p), 1 / p.z(), slope.cast<double>());
  if (q > kFarthest_per_m && q < kNearest_per_m) point = (p / (p.z() * q)).cast<float>();
}

}  // namespace sgs
