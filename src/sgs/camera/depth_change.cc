// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_change.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_lag.h"
#include "sgs/core/error.h"

namespace sgs {
namespace {

constexpr float kNearest_per_m = 50, kFarthest_per_m = 0.01f;

}  // namespace

DepthChange::DepthChange(const DepthCalibration& before, const DepthCalibration& after)
    : after_(after), difference_(after) {
  difference_.shift_px = after.shift_px - before.shift_px;
  difference_.delay_s = after.delay_s - before.delay_s;
  if (!before.offset_per_m.empty()) {
    SGS_CHECK(after.offset_per_m.empty() || before.grid == after.grid, "grids differ");
    difference_.grid = before.grid;
    difference_.offset_per_m.resize(before.offset_per_m.size(), 0.0);
    for (std::size_t k = 0; k < before.offset_per_m.size(); ++k) {
      difference_.offset_per_m[k] -= before.offset_per_m[k];
    }
  }
  prepare();
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

void DepthChange::prepare() {
  const DepthCalibration& d = difference_;
  fx_ = static_cast<float>(d.camera.fx);
  fy_ = static_cast<float>(d.camera.fy);
  cx_ = static_cast<float>(d.camera.cx);
  cy_ = static_cast<float>(d.camera.cy);
  shift_ = d.shift_px.cast<float>();
  if (d.offset_per_m.empty()) return;
  const auto per_px = [](int nodes, int pixels) {
    return pixels < 2 ? 0.0f : static_cast<float>(nodes - 1) / static_cast<float>(pixels - 1);
  };
  nodes_per_px_ = {per_px(d.grid.columns, d.camera.width), per_px(d.grid.rows, d.camera.height)};
  offsets_.clear();
  for (int y = 0; y <= d.grid.rows; ++y) {
    for (int x = 0; x <= d.grid.columns; ++x) {
      const int node =
          std::min(y, d.grid.rows - 1) * d.grid.columns + std::min(x, d.grid.columns - 1);
      offsets_.push_back(static_cast<float>(d.offset_per_m[static_cast<std::size_t>(node)]));
    }
  }
}

DepthChange::Offset DepthChange::offset_on(const Eigen::Vector3f& ray) const {
  if (offsets_.empty()) return {};
  const ImageGrid& grid = difference_.grid;
  const Eigen::Vector2f pixel(fx_ * ray.x() + cx_, fy_ * ray.y() + cy_);
  const Eigen::Vector2f last(static_cast<float>(grid.columns - 1),
                             static_cast<float>(grid.rows - 1));
  const Eigen::Vector2f asked = (pixel - shift_).cwiseProduct(nodes_per_px_);
  const Eigen::Vector2f at = asked.cwiseMax(0.0f).cwiseMin(last);
  const auto x = static_cast<std::size_t>(at.x()), y = static_cast<std::size_t>(at.y());
  const auto right = at.x() - static_cast<float>(x), down = at.y() - static_cast<float>(y);
  const float* top = offsets_.data() + y * (static_cast<std::size_t>(grid.columns) + 1) + x;
  const float* bottom = top + grid.columns + 1;
  const float above = top[0] + right * (top[1] - top[0]);
  const float below = bottom[0] + right * (bottom[1] - bottom[0]);
  // Outside of the image the offsets are those of its border.
  const float along = (1 - down) * (top[1] - top[0]) + down * (bottom[1] - bottom[0]);
  return {above + down * (below - above),
          {at.x() == asked.x() ? along * nodes_per_px_.x() : 0.0f,
           at.y() == asked.y() ? (below - above) * nodes_per_px_.y() : 0.0f}};
}

void DepthChange::apply(Eigen::Vector3f& point, Eigen::Vector3f& normal,
                        const Vector6d& lag) const {
  // At flat incidence a plane's slope says more about the noise of its normal than about depth.
  constexpr float kFlattest = 0.15f;
  if (!(point.z() > 0)) return;
  const Eigen::Vector3f ray = point / point.z();
  const float facing = normal.dot(ray);  // the plane: q = n . ray' / (facing z)
  if (std::abs(facing) < kFlattest * ray.norm()) {
    apply(point, Eigen::Vector2f(Eigen::Vector2f::Zero()), lag);
    return;
  }
  const float per_q = 1 / (facing * point.z());
  Eigen::Vector2f slope(normal.x() * per_q / fx_, normal.y() * per_q / fy_);
  const Offset offset = offset_on(ray);
  const float q = 1 / point.z() - slope.dot(shift_) + offset.per_m;
  if (!(q > kFarthest_per_m && q < kNearest_per_m)) return;
  slope += offset.slope;
  point = ray / q;
  Eigen::Vector3f turned(slope.x() * fx_, slope.y() * fy_, 0);
  turned.z() = q - turned.x() * ray.x() - turned.y() * ray.y();
  turned.normalize();
  normal = turned.dot(normal) < 0 ? Eigen::Vector3f(-turned) : turned;
  if (lag.isZero(0)) return;
  // What was measured later was seen from where the camera had moved to.
  const Eigen::Vector3f turn = lag.head<3>().cast<float>(), move = lag.tail<3>().cast<float>();
  point += turn.cross(point) + move;
  normal = (normal + turn.cross(normal)).normalized();
}

void DepthChange::apply(Eigen::Vector3f& point, const Eigen::Vector2f& slope,
                        const Vector6d& lag) const {
  if (!(point.z() > 0)) return;
  const Eigen::Vector3f ray = point / point.z();
  float q = 1 / point.z() - slope.dot(shift_) + offset_on(ray).per_m;
  if (!lag.isZero(0)) q += depth_lag_per_m(difference_.camera, ray, q, slope, lag);
  if (q > kFarthest_per_m && q < kNearest_per_m) point = ray / q;
}

}  // namespace sgs
