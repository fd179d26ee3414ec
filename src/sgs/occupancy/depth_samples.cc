// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/occupancy/depth_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace sgs::occupancy {
namespace {

/// The point of a pixel that lies on the same surface as one of depth `z`.
std::optional<Eigen::Vector3d> neighbour(const PinholeCamera& camera, const DepthImage& depth,
                                         int u, int v, double z) {
  constexpr double kStep = 0.05;  // of the depth: more is another surface
  if (!depth.contains(u, v)) return std::nullopt;
  const double other = depth(u, v);
  if (!(other > 0) || std::abs(other - z) > kStep * z) return std::nullopt;
  return camera.back_project(u, v, other);
}

/// The direction along which points left and right (or above and below) lie.
Eigen::Vector3d tangent(const std::optional<Eigen::Vector3d>& before, const Eigen::Vector3d& here,
                        const std::optional<Eigen::Vector3d>& after) {
  if (before && after) return *after - *before;
  if (after) return *after - here;
  if (before) return here - *before;
  return Eigen::Vector3d::Zero();
}

}  // namespace

std::vector<DepthSample> sample_depth(const PinholeCamera& camera, const DepthImage& depth,
                                      int stride) {
  SGS_CHECK(depth.width() == camera.width && depth.height() == camera.height && stride > 0,
            "depth must have the camera's size");
  constexpr double kGrazing = 0.02;  // cosine: a surface seen along itself has no known area
  const int reach = std::max(1, stride / 2);
  std::vector<DepthSample> samples;
  for (int v = 0; v < camera.height; v += stride) {
    for (int u = 0; u < camera.width; u += stride) {
      const double z = depth(u, v);
      if (!(z > 0)) continue;
      DepthSample sample{camera.back_project(u, v, z)};
      const auto at = [&](int du, int dv) {
        return neighbour(camera, depth, u + du * reach, v + dv * reach, z);
      };
      const Eigen::Vector3d across = tangent(at(-1, 0), sample.point, at(1, 0));
      const Eigen::Vector3d down = tangent(at(0, -1), sample.point, at(0, 1));
      const Eigen::Vector3d normal = down.cross(across);  // x right, y down: towards the camera
      const double cosine = -normal.normalized().dot(sample.point.normalized());
      if (normal.norm() > 0 && cosine > kGrazing) {
        sample.normal = normal.normalized();
        const double pixel_m2 = z * z / (camera.fx * camera.fy) * stride * stride;
        sample.area_m2 = pixel_m2 / cosine;
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

int stride_for(const PinholeCamera& camera, double voxel_m, double range_m) {
  constexpr double kPerVoxel = 1.5;
  const double pixels = voxel_m * std::min(camera.fx, camera.fy) / (kPerVoxel * range_m);
  return std::clamp(static_cast<int>(pixels), 1, 16);
}

}  // namespace sgs::occupancy
