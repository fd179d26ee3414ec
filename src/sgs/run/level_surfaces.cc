// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/level_surfaces.h"

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
    patches.push_back({normal.normalized(), area});
    areas.push_back(area);
  }
  if (patches.empty()) return patches;
  const double largest = quantile(areas, kTypicalLargest);
  for (Patch& patch : patches) patch.area_m2 = std::min(patch.area_m2, largest);
  return patches;
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
  return LevelSurfaces{up, share};
}

}  // namespace sgs::run
