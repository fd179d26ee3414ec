// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/map_statistics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace sgs::eval {

MapStatistics map_statistics(std::span<const map::Gaussian> gaussians) {
  constexpr int kBins = 40;
  constexpr double kThinnest = -4.5, kWidest = 0.5;  // 0.03 mm to 3 m
  MapStatistics s{{0, 1, kBins},
                  {kThinnest, kWidest, kBins},
                  {kThinnest, kWidest, kBins},
                  {kThinnest, kWidest, kBins}};
  for (const map::Gaussian& g : gaussians) {
    std::array<double, 3> scale = {g.log_scale[0], g.log_scale[1], g.log_scale[2]};
    std::sort(scale.begin(), scale.end());
    s.opacity.add(map::opacity<double>(g));
    s.thinnest.add(scale[0] / std::log(10.0));
    s.middle.add(scale[1] / std::log(10.0));
    s.widest.add(scale[2] / std::log(10.0));
  }
  return s;
}

namespace {

std::array<Eigen::Vector3f, 2> widest_axes(const map::Gaussian& g, float factor,
                                           const SE3& T_target_world) {
  std::array<int, 3> order = {0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return g.log_scale[a] > g.log_scale[b]; });
  const Eigen::Quaterniond rotation(g.rotation[0], g.rotation[1], g.rotation[2], g.rotation[3]);
  const Eigen::Matrix3d axes = T_target_world.R * rotation.normalized().toRotationMatrix();
  const auto axis = [&](int k) -> Eigen::Vector3f {
    return factor * std::exp(g.log_scale[k]) * axes.col(k).cast<float>();
  };
  return {axis(order[0]), axis(order[1])};
}

}  // namespace

std::vector<MapPoint> sample_points(std::span<const map::Gaussian> gaussians, std::size_t count,
                                    const SE3& T_target_world) {
  std::vector<const map::Gaussian*> solid;
  for (const map::Gaussian& g : gaussians) {
    if (g.opacity_logit > 0) solid.push_back(&g);
  }
  std::vector<MapPoint> points;
  const std::size_t kept = std::min(count, solid.size());
  const float cover =
      kept > 0 ? std::sqrt(static_cast<float>(solid.size()) / static_cast<float>(kept)) : 1.0f;
  for (std::size_t i = 0; i < kept; ++i) {
    const map::Gaussian& g = *solid[i * solid.size() / kept];
    const Eigen::Vector3d mean(g.mean[0], g.mean[1], g.mean[2]);
    points.push_back({(T_target_world * mean).cast<float>(),
                      {to_byte(g.rgb[0]), to_byte(g.rgb[1]), to_byte(g.rgb[2])},
                      widest_axes(g, cover, T_target_world)});
  }
  return points;
}

}  // namespace sgs::eval
