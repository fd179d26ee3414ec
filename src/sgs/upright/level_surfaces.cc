// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/upright/level_surfaces.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sgs/core/stopwatch.h"

namespace sgs::run {
namespace {

constexpr double kRadius_deg = 10;  ///< normals of one flat surface scatter by less

double cosine(double deg) { return std::cos(deg * std::numbers::pi / 180); }

/// Area and mean of the normals within an angle of a direction.
struct Support {
  double area = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
};

Support support_of(const std::vector<Patch>& patches, const Eigen::Vector3d& direction,
                   double radius_deg) {
  const double least = cosine(radius_deg);
  Support support;
  for (const Patch& patch : patches) {
    const double c = patch.normal.dot(direction);
    if (c < least) continue;
    support.area += patch.area_m2;
    support.mean += patch.area_m2 * patch.normal;
  }
  return support;
}

/// Follows the mean of what supports a direction until it stays (mean shift), the circle closing in
/// on what is really of one surface.
Eigen::Vector3d settle(const std::vector<Patch>& patches, Eigen::Vector3d direction) {
  constexpr double kLast_deg = 5, kShrink = 0.9;
  for (double radius = kRadius_deg; radius > kLast_deg; radius *= kShrink) {
    const Support support = support_of(patches, direction, radius);
    if (!(support.mean.norm() > 0)) break;
    direction = support.mean.normalized();
  }
  return direction;
}

/// Patches that face a direction roughly and lie at the height at which most of their area lies.
std::vector<Patch> main_level(const std::vector<Patch>& patches, const Eigen::Vector3d& up) {
  constexpr double kRoughly_deg = 25, kLevels = 10;
  std::vector<Patch> facing;
  std::vector<double> heights;
  for (const Patch& patch : patches) {
    if (patch.normal.dot(up) < cosine(kRoughly_deg)) continue;
    facing.push_back(patch);
    heights.push_back(patch.point.dot(up));
  }
  if (facing.empty()) return facing;
  const double half = (quantile(heights, 0.95) - quantile(heights, 0.05)) / (2 * kLevels);
  double best = -1, level = 0;
  for (std::size_t i = 0; i < heights.size(); i += 1 + heights.size() / 100) {
    double area = 0;
    for (std::size_t k = 0; k < heights.size(); ++k) {
      if (std::abs(heights[k] - heights[i]) <= half) area += facing[k].area_m2;
    }
    if (area <= best) continue;
    best = area;
    level = heights[i];
  }
  // Twice as far: the direction is not exact yet.
  std::erase_if(
      facing, [&](const Patch& patch) { return std::abs(patch.point.dot(up) - level) > 2 * half; });
  return facing;
}

/// The plane through the main level, what is not of it left out by the median of its distances.
/// Empty where it is not spread far beyond its own thickness in both directions, or is far from the
/// normals.
std::optional<Eigen::Vector3d> plane_normal(const std::vector<Patch>& patches,
                                            const Eigen::Vector3d& up) {
  constexpr int kIterations = 10;
  constexpr std::size_t kFewest = 30;
  constexpr double kOutlier = 4, kSpread = 8;
  std::vector<Patch> level = main_level(patches, up);
  Eigen::Vector3d normal = up;
  double spread = 0;
  for (int i = 0; i < kIterations; ++i) {
    if (level.size() < kFewest) return std::nullopt;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Patch& patch : level) mean += patch.point / static_cast<double>(level.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Patch& patch : level) {
      scatter += (patch.point - mean) * (patch.point - mean).transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
    normal = axes.eigenvectors().col(0) * (axes.eigenvectors().col(0).dot(up) < 0 ? -1 : 1);
    std::vector<double> distances;
    for (const Patch& patch : level)
      distances.push_back(std::abs((patch.point - mean).dot(normal)));
    const double median = quantile(distances, 0.5);
    spread = std::sqrt(axes.eigenvalues()[1] / static_cast<double>(level.size())) /
             std::max(1e-9, median);
    std::erase_if(level, [&](const Patch& patch) {
      return std::abs((patch.point - mean).dot(normal)) > kOutlier * median + 1e-9;
    });
  }
  if (spread < kSpread || normal.dot(up) < cosine(kRadius_deg)) return std::nullopt;
  return normal;
}

}  // namespace

std::vector<Patch> patches_of(const map::Snapshot& snapshot) {
  constexpr std::size_t kMost = 20000;
  constexpr double kTypicalLargest = 0.95;
  const std::size_t count = std::min(snapshot.anchors.size(), snapshot.gaussians.size());
  const std::size_t step = 1 + count / kMost;
  std::vector<Patch> patches;
  std::vector<double> areas;
  for (std::size_t i = 0; i < count; i += step) {
    const Eigen::Vector3d normal = snapshot.anchors[i].normal.cast<double>();
    const float* scale = snapshot.gaussians[i].log_scale;
    const double smallest = std::min({scale[0], scale[1], scale[2]});
    const double area = std::exp(double{scale[0]} + scale[1] + scale[2] - smallest);
    if (!(normal.norm() > 0.5) || !std::isfinite(area)) continue;
    patches.push_back({normal.normalized(), area, snapshot.anchors[i].point.cast<double>()});
    areas.push_back(area);
  }
  if (patches.empty()) return patches;
  const double largest = quantile(areas, kTypicalLargest);
  for (Patch& patch : patches) patch.area_m2 = std::min(patch.area_m2, largest);
  return patches;
}

void add_patches(const PinholeCamera& camera, const DepthImage& depth, const SE3& T_world_camera,
                 std::vector<Patch>& patches) {
  constexpr int kAcross = 40;           // patches in a row
  constexpr float kEdge = 0.1f;         // a larger share of the depth between neighbours is one
  constexpr double kLeastCosine = 0.2;  // noise decides the normal of what is seen more obliquely
  const int step = std::max(2, camera.width / kAcross);
  const auto point = [&](int u, int v) { return camera.back_project(u, v, depth(u, v)); };
  for (int v = 0; v + step < depth.height(); v += step) {
    for (int u = 0; u + step < depth.width(); u += step) {
      const float z = depth(u, v), right = depth(u + step, v), below = depth(u, v + step);
      if (!(std::min({z, right, below}) > 0)) continue;
      if (std::max(std::abs(right - z), std::abs(below - z)) > kEdge * z) continue;
      const Eigen::Vector3d p = point(u, v);
      Eigen::Vector3d n = (point(u, v + step) - p).cross(point(u + step, v) - p);
      const double area = n.norm();
      if (n.dot(p) > 0) n = -n;
      if (!(-n.dot(p) > kLeastCosine * area * p.norm())) continue;
      patches.push_back({T_world_camera.R * (n / area), area, T_world_camera * p});
    }
  }
}

std::optional<LevelSurfaces> find_level_surfaces(const std::vector<Patch>& patches,
                                                 const Eigen::Vector3d& near, double cone_deg) {
  constexpr std::size_t kStarts = 200;
  constexpr double kLeastShare = 0.05;
  std::vector<Eigen::Vector3d> starts;
  double whole = 0;
  for (const Patch& patch : patches) {
    whole += patch.area_m2;
    if (patch.normal.dot(near) >= cosine(cone_deg)) starts.push_back(patch.normal);
  }
  Support best;
  Eigen::Vector3d up = near;
  const std::size_t step = 1 + starts.size() / kStarts;
  for (std::size_t i = 0; i < starts.size(); i += step) {
    const Support support = support_of(patches, starts[i], kRadius_deg);
    if (support.area <= best.area) continue;
    best = support;
    up = starts[i];
  }
  if (!(best.area > 0)) return std::nullopt;
  up = settle(patches, up);
  const double share = support_of(patches, up, kRadius_deg).area / whole;
  if (share < kLeastShare || up.dot(near) < cosine(cone_deg)) return std::nullopt;
  if (const auto exact = plane_normal(patches, up)) up = *exact;
  return LevelSurfaces{up, share};
}

}  // namespace sgs::run
