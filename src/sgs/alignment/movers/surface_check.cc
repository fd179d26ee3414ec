// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/surface_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>

#include "sgs/camera/depth_noise.h"

namespace sgs::alignment {
namespace {

constexpr float kWidths = 3;  // of the noise, beyond which nothing is noise
constexpr float kNearest_m = 0.05f;
constexpr int kMostReach = 2;  // pixels beside a place that are looked at

// By how much a point moves against the camera, metres per second.
Eigen::Vector3f speed_of(const Eigen::Vector3f& point, const Vector6d& velocity) {
  return velocity.head<3>().cast<float>().cross(point) + velocity.tail<3>().cast<float>();
}

struct Range {
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
};

// Of what is measured around a place, `reach` pixels beyond the four that surround it.
Range range_around(const DepthImage& depth, int u, int v, int reach) {
  Range out;
  for (int y = v - reach; y <= v + 1 + reach; ++y) {
    const float* row = depth.row(y);
    for (int x = u - reach; x <= u + 1 + reach; ++x) {
      if (!(row[x] > 0)) continue;
      out.nearest = std::min(out.nearest, row[x]);
      out.farthest = std::max(out.farthest, row[x]);
    }
  }
  return out;
}

// Whether anything is, of a cell and of so many cells around it.
bool is_measured(const DepthImage& depth, int column, int row, int around) {
  constexpr int kCell = SurfaceCheck::kCell;
  for (int v = std::max(0, (row - around) * kCell);
       v < std::min(depth.height(), (row + around + 1) * kCell); ++v) {
    const float* begin = depth.row(v) + std::max(0, (column - around) * kCell);
    const float* end = depth.row(v) + std::min(depth.width(), (column + around + 1) * kCell);
    if (std::any_of(begin, end, [](float z) { return z > 0; })) return true;
  }
  return false;
}

}  // namespace

float nearest_measured(const CoarseDepth& frame) {
  const DepthImage& depth = frame.depth;
  constexpr double kNearer = 0.01;  // share
  std::vector<float> z;
  for (int v = 0; v < depth.height(); ++v) {
    std::copy_if(depth.row(v), depth.row(v) + depth.width(), std::back_inserter(z),
                 [](float d) { return d > 0; });
  }
  if (z.empty()) return std::numeric_limits<float>::infinity();
  const auto at = z.begin() + static_cast<std::ptrdiff_t>(kNearer * static_cast<double>(z.size()));
  std::nth_element(z.begin(), at, z.end());
  return *at;
}

void check_covered(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now,
                   float nearest_m, std::vector<float>& off) {
  const SE3 T_now_then = T_then_now.inverse();
  const int columns = now.depth.width() / SurfaceCheck::kCell;
  const int rows = now.depth.height() / SurfaceCheck::kCell;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x = column * SurfaceCheck::kCell + 1, y = row * SurfaceCheck::kCell + 1;
      const float z = then.depth(x, y);
      if (!(z > 0)) continue;
      const Eigen::Vector3d p = T_now_then * then.camera.back_project(x, y, double{z});
      if (!(p.z() >= double{nearest_m})) continue;
      const Eigen::Vector2d pixel = now.camera.project(p);
      if (!(pixel.x() >= 0 && pixel.y() >= 0)) continue;
      const int i = static_cast<int>(pixel.x()) / SurfaceCheck::kCell;
      const int j = static_cast<int>(pixel.y()) / SurfaceCheck::kCell;
      if (i >= columns || j >= rows) continue;
      if (!is_measured(then.depth, i, j, 0) || is_measured(now.depth, i, j, 1)) continue;
      off[static_cast<std::size_t>(j * columns + i)] = 1;
    }
  }
}

SurfaceCheck check_surface(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now,
                           const CheckOptions& options) {
  SurfaceCheck out;
  out.columns = now.depth.width() / SurfaceCheck::kCell;
  const int rows = now.depth.height() / SurfaceCheck::kCell;
  out.off.assign(static_cast<std::size_t>(out.columns * rows), SurfaceCheck::kUnknown);
  const Eigen::Matrix3f R = T_then_now.R.cast<float>();
  const Eigen::Vector3f t = T_then_now.t.cast<float>();
  const auto f = [](double x) { return static_cast<float>(x); };
  const float fx = f(now.camera.fx), fy = f(now.camera.fy), cx = f(now.camera.cx),
              cy = f(now.camera.cy);
  const int stride = options.stride;
  const float noise = std::sqrt(2.0f) * f(options.noise_ratio);
  const registration::ReadoutMotion rows_now(now.motion.readout), rows_then(then.motion.readout);
  for (int row = stride / 2; row < rows; row += stride) {
    for (int column = stride / 2; column < out.columns; column += stride) {
      const int x = column * SurfaceCheck::kCell + 1, y = row * SurfaceCheck::kCell + 1;
      const float z = now.depth(x, y);
      if (!(z > 0)) continue;
      const Eigen::Vector3f seen_at((f(x) - cx) / fx * z, (f(y) - cy) / fy * z, z);
      const Eigen::Vector3f p = rows_now.to_middle(seen_at, now.offset(f(y)));
      const Eigen::Vector3f middle = R * p + t;
      if (!(middle.z() > kNearest_m)) continue;
      const float row_then = middle.y() / middle.z() * fy + cy;
      const Eigen::Vector3f q = rows_then.to_row(middle, then.offset(row_then));
      if (!(q.z() > kNearest_m)) continue;
      const Eigen::Vector3f drift =
          f(options.clock_s) * (speed_of(p, now.motion.velocity).cwiseAbs() +
                                speed_of(q, then.motion.velocity).cwiseAbs());
      const float across_px = std::max(drift.x() * fx, drift.y() * fy) / q.z();
      const int reach = std::min(kMostReach, static_cast<int>(std::lround(across_px)));
      const float u = q.x() / q.z() * fx + cx, v = q.y() / q.z() * fy + cy;
      const float rim = f(reach);
      if (!(u >= rim && v >= rim && u < f(then.depth.width() - 1) - rim &&
            v < f(then.depth.height() - 1) - rim)) {
        continue;
      }
      const Range seen = range_around(then.depth, static_cast<int>(u), static_cast<int>(v), reach);
      if (!(seen.farthest > 0)) continue;
      const float width = noise * depth_sigma_m(q.z()) + drift.z() / kWidths;
      const float before = (seen.nearest - q.z()) / width, behind = (q.z() - seen.farthest) / width;
      if (behind > kWidths) continue;
      const float e = std::max({before, behind, 0.0f}) / kWidths;
      const float off = std::min(1.0f, e * e);
      out.off[static_cast<std::size_t>(row * out.columns + column)] = off;
      out.support += 1 - double{off};
    }
  }
  return out;
}

}  // namespace sgs::alignment
