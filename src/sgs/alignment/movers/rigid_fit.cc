// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/rigid_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "sgs/camera/depth_noise.h"

namespace sgs::alignment {
namespace {

// How a fit is made; lengths of residuals in widths of the noise.
struct Fit {
  static constexpr int kStride = 4;  // pixels between the points of a frame that are asked
  static constexpr int kSteps = 5;
  static constexpr int kFewest = 100;         // points
  static constexpr float kHalf = 3;           // residual that counts half as much
  static constexpr float kFarthest = 12;      // beyond it a point says nothing
  static constexpr float kOneSurface = 0.1f;  // largest ratio of depths between its neighbours
  static constexpr float kSteepest = 0.3f;    // least cosine of the angle of sight
  static constexpr float kNearest_m = 0.05f;
  // A step is some centimetre, or hundredth of a radian: 1/m^2.
  static constexpr double kLikely = 1e4;
};

struct Plane {
  Eigen::Vector3f point, normal;
};

Eigen::Vector3f point_at(const CoarseDepth& d, int u, int v) {
  const PinholeCamera& c = d.camera;
  const float z = d.depth(u, v);
  return {(static_cast<float>(u) - static_cast<float>(c.cx)) / static_cast<float>(c.fx) * z,
          (static_cast<float>(v) - static_cast<float>(c.cy)) / static_cast<float>(c.fy) * z, z};
}

// Of a pixel with four neighbours on one surface.
std::optional<Plane> plane_at(const CoarseDepth& d, int u, int v) {
  if (u < 1 || v < 1 || u + 1 >= d.depth.width() || v + 1 >= d.depth.height()) return {};
  const float z = d.depth(u, v);
  for (const float beside :
       {d.depth(u - 1, v), d.depth(u + 1, v), d.depth(u, v - 1), d.depth(u, v + 1)}) {
    if (!(beside > 0) || std::abs(beside - z) > Fit::kOneSurface * z) return {};
  }
  const Eigen::Vector3f across = point_at(d, u + 1, v) - point_at(d, u - 1, v);
  const Eigen::Vector3f down = point_at(d, u, v + 1) - point_at(d, u, v - 1);
  return Plane{point_at(d, u, v), across.cross(down).normalized()};
}

std::vector<Eigen::Vector3f> points_of(const CoarseDepth& d,
                                       const registration::CellMask& without) {
  const registration::ReadoutMotion rows(d.motion.readout);
  std::vector<Eigen::Vector3f> out;
  for (int v = Fit::kStride / 2; v < d.depth.height(); v += Fit::kStride) {
    for (int u = Fit::kStride / 2; u < d.depth.width(); u += Fit::kStride) {
      if (d.depth(u, v) > 0 && !without.at(u * d.step_px, v * d.step_px))
        out.push_back(rows.to_middle(point_at(d, u, v), d.offset(static_cast<float>(v))));
    }
  }
  return out;
}

// A step of the camera, in then's coordinates; zero where too little is seen.
Vector6d step(const std::vector<Eigen::Vector3f>& points, const CoarseDepth& then, const SE3& T) {
  const Eigen::Matrix3f R = T.R.cast<float>();
  const Eigen::Vector3f t = T.t.cast<float>();
  const auto f = [](double x) { return static_cast<float>(x); };
  const float fx = f(then.camera.fx), fy = f(then.camera.fy), cx = f(then.camera.cx),
              cy = f(then.camera.cy);
  const registration::ReadoutMotion rows(then.motion.readout);
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  int used = 0;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f middle = R * p + t;
    if (!(middle.z() > Fit::kNearest_m)) continue;
    const Eigen::Vector3f q = rows.to_row(middle, then.offset(middle.y() / middle.z() * fy + cy));
    if (!(q.z() > Fit::kNearest_m)) continue;
    const float u = q.x() / q.z() * fx + cx, v = q.y() / q.z() * fy + cy;
    if (!(u > 0 && v > 0 && u < f(then.depth.width()) && v < f(then.depth.height()))) continue;
    const auto plane =
        plane_at(then, static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
    if (!plane) continue;
    const float width = std::sqrt(2.0f) * depth_sigma_m(q.z()) *
                        std::max(Fit::kSteepest, std::abs(plane->normal.z()));
    const float e = plane->normal.dot(q - plane->point) / width;
    if (!(std::abs(e) < Fit::kFarthest)) continue;
    const float root = 1 / (1 + (e / Fit::kHalf) * (e / Fit::kHalf));
    const Eigen::Vector3d normal = plane->normal.cast<double>();
    Vector6d weighted;
    weighted.head<3>() = q.cast<double>().cross(normal);
    weighted.tail<3>() = normal;
    weighted *= double{root / width};
    H.noalias() += weighted * weighted.transpose();
    b += weighted * double{root * e};
    ++used;
  }
  if (used < Fit::kFewest) return Vector6d::Zero();
  H.diagonal().array() += Fit::kLikely;
  const Vector6d xi = -H.ldlt().solve(b);
  return xi.allFinite() ? xi : Vector6d(Vector6d::Zero());
}

}  // namespace

SE3 fit_rigid(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now,
              const registration::CellMask& without) {
  const std::vector<Eigen::Vector3f> points = points_of(now, without);
  SE3 T = T_then_now;
  for (int i = 0; i < Fit::kSteps; ++i) T = SE3::exp(step(points, then, T)) * T;
  return T;
}

}  // namespace sgs::alignment
